//! What was meant by a command that there is not.

use clap::Error;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Slips of the hand that are forgiven: letters too many, too few, wrong, or in the wrong order.
const SLIPS: usize = 2;

/// An error with a suggestion, where a word is close to a command: clap's own measure holds letters of short
/// words that changed places (`rnu`) for other words.
pub(crate) fn with(mut error: Error, known: &[String]) -> Error {
    let is_unknown = error.kind() == ErrorKind::InvalidSubcommand;
    if !is_unknown || error.get(ContextKind::SuggestedSubcommand).is_some() {
        return error;
    }
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return error };
    let nearest = nearest(word, known);
    if !nearest.is_empty() {
        error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(nearest));
    }
    error
}

/// The commands that fewest slips make of a word.
fn nearest(word: &str, known: &[String]) -> Vec<String> {
    // Of a word of three letters two wrong ones leave nothing.
    let most = SLIPS.min(word.chars().count() / 3);
    let slips = |name: &String| strsim::damerau_levenshtein(word, name);
    let fewest = known.iter().map(slips).min().filter(|fewest| *fewest <= most);
    known.iter().filter(|name| Some(slips(name)) == fewest).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_hand_are_understood() {
        let known = ["run", "status", "view", "viz", "verify"].map(str::to_owned);
        for (word, meant) in
            [("rnu", "run"), ("ru", ""), ("viewx", "view"), ("statsu", "status"), ("xyz", "")]
        {
            assert_eq!(nearest(word, &known).join(" "), meant, "{word}");
        }
    }
}
