//! Pages with their data inside: a built template with its marks replaced, everything escaped.

use serde::Serialize;

const TITLE_MARK: &str = "<!--fga:title-->";
const CONNECT_MARK: &str = "fga:connect";
const DATA_MARK: &str = "<!--fga:data-->";

/// The template with its title, its allowed connections and its data. The function looks for the marks
/// only in the template, never in the inserted text.
pub(crate) fn fill(template: &str, title: &str, data: &str, connect: &str) -> String {
    let mut page = String::with_capacity(template.len() + data.len() + title.len());
    let mut rest = template;
    for (mark, text) in [
        (CONNECT_MARK, connect),
        (TITLE_MARK, escape_html(title).as_str()),
        (DATA_MARK, data),
    ] {
        if let Some((before, after)) = rest.split_once(mark) {
            page.push_str(before);
            page.push_str(text);
            rest = after;
        }
    }
    page.push_str(rest);
    page
}

/// JSON that is safe inside a script element; numbers that are not finite become `null`.
pub(crate) fn json(value: &impl Serialize) -> String {
    // The types here are plain structures with text keys, so serialisation cannot fail.
    escape_json(&serde_json::to_string(value).unwrap_or_default())
}

/// Escapes characters that could end the script element, or that scripts reject, as `\\u`.
/// In JSON they occur only inside strings, where the escape means the same.
fn escape_json(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '<' => escaped.push_str("\\u003c"),
            '>' => escaped.push_str("\\u003e"),
            '&' => escaped.push_str("\\u0026"),
            '\u{2028}' => escaped.push_str("\\u2028"),
            '\u{2029}' => escaped.push_str("\\u2029"),
            _ => escaped.push(c),
        }
    }
    escaped
}

fn escape_html(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_templates_have_each_mark_once_in_order() {
        let list = include_str!("../assets/list.html");
        let replay = include_str!("../assets/replay.html");
        for template in [list, replay] {
            let places: Vec<usize> = [CONNECT_MARK, TITLE_MARK, DATA_MARK]
                .iter()
                .map(|mark| {
                    assert_eq!(template.matches(mark).count(), 1, "{mark}");
                    template.find(mark).unwrap_or_default()
                })
                .collect();
            assert!(places.is_sorted());
        }
    }

    #[test]
    fn inserted_text_is_not_searched_again() {
        let template = "fga:connect|<!--fga:title-->|<!--fga:data-->";
        let page = fill(template, "<!--fga:data-->", "fga:connect", "'none'");
        assert_eq!(page, "'none'|&lt;!--fga:data--&gt;|fga:connect");
    }
}
