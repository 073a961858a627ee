//! Markup that any reader accepts.

/// Checks that every open tag closes in order and that every number is one.
pub(crate) fn assert_well_formed(name: &str, markup: &str) {
    let mut open: Vec<&str> = Vec::new();
    // The style of a page is in its head, which is not checked; that of a picture is.
    let body = match markup.split_once("</style>") {
        Some((_, body)) if markup.starts_with("<!DOCTYPE html>") => body,
        _ => markup,
    };
    for piece in body.split('<').skip(1) {
        let (tag, _) = piece.split_once('>').expect("a tag ends");
        if let Some(closing) = tag.strip_prefix('/') {
            // The check skips everything before the style of a page.
            if matches!(closing, "head" | "html") && open.is_empty() {
                continue;
            }
            assert_eq!(open.pop(), Some(closing), "{name}");
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().expect("a tag has a name"));
        }
    }
    assert!(open.is_empty(), "{name}: {open:?}");
    for bad in ["NaN", "inf"] {
        let at = body
            .find(bad)
            .map(|at| &body[at.saturating_sub(60)..at + 3]);
        assert_eq!(at, None, "{name}");
    }
}
