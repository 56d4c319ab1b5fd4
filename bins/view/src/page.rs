//! The page, bundled from `viewer/`.

/// What `viewer/build.mjs` wrote.
const INDEX: &str = include_str!("../assets/index.html");
pub(crate) const APP: &str = include_str!("../assets/app.js");
pub(crate) const WORKER: &str = include_str!("../assets/worker.js");
pub(crate) const STYLE: &str = include_str!("../assets/style.css");

/// Where the page says that its style and its scripts go.
const STYLE_MARK: &str = "<!--style-->";
const SCRIPTS_MARK: &str = "<!--scripts-->";

/// The page as the server gives it: style and scripts are files beside it.
pub(crate) fn served() -> String {
    filled("<link rel=\"stylesheet\" href=\"style.css\">", "<script src=\"app.js\"></script>")
}

/// The page with everything inside: `files` are pairs of path and base64.
pub(crate) fn embedded(files: &[(String, String)]) -> String {
    let mut scripts = String::new();
    for (path, base64) in files {
        scripts.push_str(&format!(
            "<script type=\"text/plain\" data-file=\"{}\">{base64}</script>\n",
            attribute(path)
        ));
    }
    scripts.push_str(&format!(
        "<script type=\"text/plain\" id=\"worker-source\">{}</script>\n",
        within_script(WORKER)
    ));
    scripts.push_str(&format!("<script>{}</script>", within_script(APP)));
    filled(&format!("<style>{STYLE}</style>"), &scripts)
}

fn filled(style: &str, scripts: &str) -> String {
    INDEX.replacen(STYLE_MARK, style, 1).replacen(SCRIPTS_MARK, scripts, 1)
}

/// A script's text so that nothing in it ends the element: in strings, templates and regular expressions of
/// JavaScript `<\/script` and `<\!--` are the same text.
fn within_script(text: &str) -> String {
    text.replace("</script", "<\\/script").replace("<!--", "<\\!--")
}

fn attribute(text: &str) -> String {
    text.replace('&', "&amp;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_both_marks_once() {
        assert_eq!(INDEX.matches(STYLE_MARK).count(), 1);
        assert_eq!(INDEX.matches(SCRIPTS_MARK).count(), 1);
        assert!(served().contains("src=\"app.js\"") && served().contains("href=\"style.css\""));
    }

    #[test]
    fn nothing_within_a_script_ends_it() {
        assert_eq!(within_script("a = '</script>'; b = '<!-- '"), "a = '<\\/script>'; b = '<\\!-- '");
        let page = embedded(&[("a\"&b".to_owned(), "QUJD".to_owned())]);
        assert!(page.contains("data-file=\"a&quot;&amp;b\">QUJD</script>"));
        // Data, worker and page: nothing else opens or closes a script.
        assert_eq!(page.matches("</script").count(), 3);
    }
}
