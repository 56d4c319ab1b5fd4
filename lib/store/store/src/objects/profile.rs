//! The files in which the tools of S3 keep profiles.

use std::path::PathBuf;

use object_store::aws::AmazonS3ConfigKey as Key;

/// A profile of `~/.aws/credentials` and `~/.aws/config`. Keys that it holds are understood, and region and
/// endpoint; roles and single sign-on are not.
pub(super) struct Profile {
    pub(super) name: String,
    pub(super) files: Vec<String>,
    pub(super) settings: Vec<(Key, String)>,
}

impl Profile {
    /// The profile that `AWS_PROFILE` names, else `default`; none where no file has it.
    ///
    /// # Errors
    /// A profile was asked for by name, and no file has it.
    pub(super) fn read() -> Result<Option<Self>, String> {
        let asked = std::env::var("AWS_PROFILE").ok().filter(|name| !name.is_empty());
        let name = asked.clone().unwrap_or_else(|| "default".into());
        let file = |variable: &str, usual: &str| {
            let named = std::env::var_os(variable).map(PathBuf::from);
            named.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(usual)))
        };
        let mut profile = Self { name, files: Vec::new(), settings: Vec::new() };
        for (variable, usual) in
            [("AWS_SHARED_CREDENTIALS_FILE", ".aws/credentials"), ("AWS_CONFIG_FILE", ".aws/config")]
        {
            let Some(path) = file(variable, usual) else { continue };
            let Ok(text) = std::fs::read_to_string(&path) else { continue };
            if let Some(settings) = section(&text, &profile.name) {
                profile.files.push(path.display().to_string());
                profile.settings.extend(settings);
            }
        }
        match (profile.files.is_empty(), asked) {
            (true, Some(name)) => Err(format!("no file has the profile `{name}` that AWS_PROFILE names")),
            (true, None) => Ok(None),
            (false, _) => Ok(Some(profile)),
        }
    }

    /// Whether a setting is part of the credentials: those of two places do not mix.
    pub(super) fn is_key(key: Key) -> bool {
        matches!(key, Key::AccessKeyId | Key::SecretAccessKey | Key::Token)
    }

    pub(super) fn has_keys(&self) -> bool {
        self.settings.iter().any(|(key, _)| *key == Key::AccessKeyId)
    }
}

/// What a file says of a profile, or `None` where it has none of this name.
fn section(text: &str, name: &str) -> Option<Vec<(Key, String)>> {
    let mut settings = None;
    let mut is_inside = false;
    for line in text.lines().map(str::trim_end) {
        if let Some(header) = line.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            let header = header.0.trim();
            is_inside = header == name || header.strip_prefix("profile ").map(str::trim) == Some(name);
            if is_inside {
                settings.get_or_insert_with(Vec::new);
            }
            continue;
        }
        // What is indented belongs to a setting of its own, as `s3 =` has.
        if !is_inside || line.starts_with([' ', '\t', '#', ';']) {
            continue;
        }
        let Some((key, value)) = line.split_once('=') else { continue };
        let key = match key.trim().to_ascii_lowercase().as_str() {
            "aws_access_key_id" => Key::AccessKeyId,
            "aws_secret_access_key" => Key::SecretAccessKey,
            "aws_session_token" => Key::Token,
            "region" => Key::Region,
            "endpoint_url" => Key::Endpoint,
            _ => continue,
        };
        settings.get_or_insert_with(Vec::new).push((key, value.trim().to_owned()));
    }
    settings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_is_found_by_its_name() {
        let text = "# comment\n[default]\naws_access_key_id = A\n\n[profile lab]\nregion=eu-north-1\n\
            s3 =\n  endpoint_url = inner\nendpoint_url = http://store:9000\naws_secret_access_key=x=y\n";
        let lab = section(text, "lab").expect("is there");
        let wanted = [
            (Key::Region, "eu-north-1"),
            (Key::Endpoint, "http://store:9000"),
            (Key::SecretAccessKey, "x=y"),
        ];
        assert_eq!(lab, wanted.map(|(key, value)| (key, value.to_owned())));
        assert_eq!(section(text, "default").expect("is there").len(), 1);
        assert!(section(text, "la").is_none());
    }
}
