//! What one file of a crate says: its types and constants, the names that it takes, and where its tests are.

use alloc::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Names from the root of a crate to a module, or to an item in one.
pub(crate) type Names = Vec<String>;

/// What the files of a crate say.
#[derive(Default)]
pub(crate) struct Sources {
    /// File of each module.
    pub(crate) modules: BTreeMap<Names, String>,
    /// Modules that only tests have.
    pub(crate) of_tests: BTreeSet<Names>,
    /// Paths that a module takes by `use`, by the name that it gives each.
    pub(crate) imports: BTreeMap<(Names, String), Names>,
    /// Paths that stand in a module.
    pub(crate) paths: Vec<(Names, Names)>,
    /// Files that define a type, by its name.
    pub(crate) types: BTreeMap<String, Vec<String>>,
    /// Constants that hold a number to be tuned.
    pub(crate) tuned: usize,
}

/// Reads on from the tokens of a file or of a group in it.
struct TokenReader<'a> {
    sources: &'a mut Sources,
    file: &'a str,
}

impl Sources {
    /// Reads a file, whose module has these names. What only tests have is passed over.
    pub(crate) fn read(&mut self, file: &str, module: &Names, text: &str) -> Result<(), String> {
        let tokens = text.parse::<TokenStream>();
        let tokens = tokens.map_err(|error| format!("{file}: {error}"))?;
        self.modules.insert(module.clone(), file.to_owned());
        let mut reader = TokenReader {
            sources: self,
            file,
        };
        reader.walk(tokens, module, true);
        Ok(())
    }
}

impl TokenReader<'_> {
    /// Walks over tokens; `is_module` where items of a module stand.
    fn walk(&mut self, tokens: TokenStream, module: &Names, is_module: bool) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            let rest = tokens.get(at + 1..).unwrap_or_default();
            let name = rest.first().and_then(ident);
            match (ident(token).as_deref(), name) {
                (Some("use"), _) => {
                    let length = length(rest, |token| is_punct(token, ';'));
                    self.uses(
                        rest.get(..length).unwrap_or_default(),
                        module,
                        &Names::new(),
                    );
                    at += length;
                }
                (Some("mod"), Some(name)) => {
                    if let Some(TokenTree::Group(group)) = rest.get(1) {
                        let inner = below(module, &name);
                        let file = self.file.to_owned();
                        self.sources.modules.insert(inner.clone(), file);
                        self.walk(group.stream(), &inner, true);
                        at += 1;
                    }
                    at += 1;
                }
                (Some("struct" | "enum" | "trait" | "type"), Some(name)) if is_module => {
                    let files = self.sources.types.entry(name).or_default();
                    files.push(self.file.to_owned());
                    at += 1;
                }
                (Some("const"), Some(name))
                    if !["fn", "unsafe", "extern", "async"].contains(&name.as_str())
                        && !at
                            .checked_sub(1)
                            .is_some_and(|before| is_punct(&tokens[before], '<')) =>
                {
                    self.sources.tuned += usize::from(is_tuned(rest));
                }
                (Some(_), _) => {
                    let path = path(tokens.get(at..).unwrap_or_default());
                    if path.len() > 1 {
                        at += 3 * (path.len() - 1);
                        self.sources.paths.push((module.clone(), path));
                    }
                }
                (None, _) => match (token, rest.first()) {
                    (TokenTree::Punct(mark), Some(TokenTree::Group(attribute)))
                        if mark.as_char() == '#' && is_of_tests(&attribute.stream()) =>
                    {
                        at += 1 + self.pass_over(rest.get(1..).unwrap_or_default(), module);
                    }
                    (TokenTree::Group(group), _) => self.walk(group.stream(), module, false),
                    _ => {}
                },
            }
            at += 1;
        }
    }

    /// Length of the item of tests that tokens begin with.
    fn pass_over(&mut self, tokens: &[TokenTree], module: &Names) -> usize {
        let is_word = |word: &str| {
            tokens
                .iter()
                .position(|token| ident(token).as_deref() == Some(word))
        };
        let ends_with_mark = ["use", "const", "static", "type"]
            .iter()
            .any(|word| is_word(word).is_some_and(|place| place < 2));
        let end = length(tokens, |token| {
            let is_block =
                matches!(token, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace);
            is_punct(token, ';') || (is_block && !ends_with_mark)
        });
        let item = tokens.get(..end).unwrap_or_default();
        if let Some(place) = item
            .iter()
            .position(|token| ident(token).as_deref() == Some("mod"))
            && let Some(name) = item.get(place + 1).and_then(ident)
        {
            self.sources.of_tests.insert(below(module, &name));
        }
        end + 1
    }

    /// Notes what a tree of `use` takes.
    fn uses(&mut self, tree: &[TokenTree], module: &Names, prefix: &Names) {
        let branches = tree.split(|token| is_punct(token, ','));
        // A comma may stand behind the last one.
        for branch in branches.filter(|branch| !branch.is_empty()) {
            let mut names = prefix.clone();
            let mut given = None;
            let mut tokens = branch.iter();
            while let Some(token) = tokens.next() {
                match token {
                    TokenTree::Group(group) => {
                        let inner: Vec<_> = group.stream().into_iter().collect();
                        self.uses(&inner, module, &names);
                        names.clear();
                    }
                    TokenTree::Ident(word) if word == "as" => given = tokens.next().and_then(ident),
                    TokenTree::Ident(word) if word == "self" && !names.is_empty() => {}
                    TokenTree::Ident(word) => names.push(word.to_string()),
                    // Everything of a module: a name that no module has.
                    TokenTree::Punct(mark) if mark.as_char() == '*' => names.push("*".to_owned()),
                    _ => {}
                }
            }
            if let Some(last) = names.last().cloned() {
                let given = given.unwrap_or(last);
                self.sources.paths.push((module.clone(), names.clone()));
                self.sources.imports.insert((module.clone(), given), names);
            }
        }
    }
}

/// Names of a module's child.
pub(crate) fn below(module: &Names, name: &str) -> Names {
    let mut names = module.clone();
    names.push(name.to_owned());
    names
}

fn ident(token: &TokenTree) -> Option<String> {
    match token {
        TokenTree::Ident(word) => Some(word.to_string()),
        _ => None,
    }
}

fn is_punct(token: &TokenTree, mark: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == mark)
}

/// Number of tokens before the first that ends them.
fn length(tokens: &[TokenTree], ends: impl Fn(&TokenTree) -> bool) -> usize {
    tokens.iter().position(ends).unwrap_or(tokens.len())
}

/// The path that tokens begin with: names with `::` between.
fn path(tokens: &[TokenTree]) -> Names {
    let mut names = Names::new();
    let mut rest = tokens;
    while let Some(name) = rest.first().and_then(ident) {
        names.push(name);
        match rest {
            [_, first, second, after @ ..] if is_punct(first, ':') && is_punct(second, ':') => {
                rest = after;
            }
            _ => break,
        }
    }
    names
}

/// Whether an attribute keeps an item to tests.
fn is_of_tests(attribute: &TokenStream) -> bool {
    let text = attribute.to_string().replace(' ', "");
    ["cfg(test)", "cfg(doctest)", "cfg(all(test,"]
        .iter()
        .any(|start| text.starts_with(start))
}

/// Whether the tokens after `const` hold a number to be tuned: not zero, no tolerance below a thousandth, no bound
/// from 10⁹ on.
fn is_tuned(tokens: &[TokenTree]) -> bool {
    let item = tokens.split(|token| is_punct(token, ';')).next();
    let mut parts = item
        .unwrap_or_default()
        .splitn(2, |token| is_punct(token, '='));
    parts.next();
    parts
        .next()
        .is_some_and(|value| value.iter().any(has_tuned))
}

fn has_tuned(token: &TokenTree) -> bool {
    match token {
        TokenTree::Group(group) => group.stream().into_iter().any(|token| has_tuned(&token)),
        TokenTree::Literal(literal) => {
            let text = literal.to_string().replace('_', "");
            let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
            let number = text.parse().or_else(|_| digits.parse::<f64>());
            number.is_ok_and(|number: f64| (1e-3..1e9).contains(&number))
        }
        _ => false,
    }
}
