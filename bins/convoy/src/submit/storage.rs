//! What a pod is given: the names of objects, and a store that it can reach.

use std::path::{Path, PathBuf};

/// A PersistentVolumeClaim, and where it is seen: `NAME` (in the folder of the store) or `NAME:FOLDER`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Claim {
    name: String,
    folder: Option<PathBuf>,
}

impl std::str::FromStr for Claim {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, folder) = match text.split_once(':') {
            Some((name, folder)) => (name, Some(PathBuf::from(folder))),
            None => (text, None),
        };
        match folder {
            Some(folder) if !folder.is_absolute() => Err("expected NAME or NAME:/FOLDER".to_owned()),
            folder => Ok(Self { name: object_name(name)?, folder }),
        }
    }
}

/// The name of an object of Kubernetes.
pub(super) fn object_name(text: &str) -> Result<String, String> {
    let is_good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit();
    let is_name = text.len() <= 253
        && text.starts_with(is_good)
        && text.ends_with(is_good)
        && text.chars().all(|c| is_good(c) || c == '-' || c == '.');
    match is_name {
        true => Ok(text.to_owned()),
        false => Err("expected small letters, digits, - and .".to_owned()),
    }
}

/// The name of an image.
pub(super) fn image_name(text: &str) -> Result<String, String> {
    match text.is_empty() || text.chars().any(|c| c.is_whitespace() || c.is_control()) {
        true => Err("expected the name of an image".to_owned()),
        false => Ok(text.to_owned()),
    }
}

/// Where containers find the store.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Storage {
    /// By its URL.
    Url(String),
    /// In a folder on a claim.
    Claimed {
        /// The store.
        store: PathBuf,
        /// The claim's name.
        claim: String,
        /// Where the claim is seen.
        folder: PathBuf,
    },
}

/// Kinds of stores that containers reach by a URL.
const URLS: [&str; 3] = ["s3://", "az://", "gs://"];

impl Storage {
    /// What a store, by its URL or its whole path, is to containers.
    ///
    /// # Errors
    /// It is nothing to them.
    pub(super) fn of(store: &Path, claim: Option<&Claim>) -> Result<Self, String> {
        let text = store.display().to_string();
        match claim {
            None if URLS.iter().any(|kind| text.starts_with(kind)) => Ok(Self::Url(text)),
            None => Err(format!(
                "{text}: pods have no folders of this machine: give a store by s3://, az:// or gs://, \
                 or --volume-claim NAME that holds the folder"
            )),
            Some(_) if text.contains("://") => Err(format!(
                "--volume-claim holds folders, and {text} is none: give the path of one, or no claim"
            )),
            Some(Claim { name, folder }) => {
                let folder = folder.as_deref().unwrap_or(store);
                if !store.starts_with(folder) || folder.parent().is_none() || text.contains(':') {
                    return Err(format!(
                        "--volume-claim: {text} is no folder that a claim at {} can hold",
                        folder.display()
                    ));
                }
                let (store, folder) = (store.to_owned(), folder.to_owned());
                Ok(Self::Claimed { store, claim: name.clone(), folder })
            }
        }
    }

    /// As `--store` takes it.
    pub(super) fn word(&self) -> String {
        match self {
            Self::Url(url) => url.clone(),
            Self::Claimed { store, .. } => store.display().to_string(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_objects() {
        for wrong in ["", "Rain", "rain_1", "-rain", "rain-", "rain in"] {
            assert!(object_name(wrong).is_err(), "{wrong}");
        }
        assert!(image_name("a b").is_err() && image_name("").is_err());
        assert!(object_name("rain-1.lab").is_ok() && image_name("registry:5000/convoy@sha256:0").is_ok());
    }

    #[test]
    fn stores_are_reached_by_a_url_or_on_a_claim() {
        let claim = |text: &str| text.parse::<Claim>().expect("is one");
        let of = |store: &str, claim: Option<Claim>| Storage::of(Path::new(store), claim.as_ref());
        assert_eq!(of("gs://sets/rain", None), Ok(Storage::Url("gs://sets/rain".into())));
        let held = of("/data/rain", Some(claim("sets"))).expect("is held");
        assert!(matches!(&held, Storage::Claimed { folder, .. } if folder == Path::new("/data/rain")));
        let refused = [
            of("/data/rain", None),
            of("file:///data/rain", None),
            of("s3://sets/rain", Some(claim("sets"))),
            of("/data/rain", Some(claim("sets:/other"))),
            of("/rain", Some(claim("sets:/"))),
        ];
        let refused = refused.map(|storage| storage.expect_err("is refused"));
        insta::assert_snapshot!(refused.join("\n"), @"
        /data/rain: pods have no folders of this machine: give a store by s3://, az:// or gs://, or --volume-claim NAME that holds the folder
        file:///data/rain: pods have no folders of this machine: give a store by s3://, az:// or gs://, or --volume-claim NAME that holds the folder
        --volume-claim holds folders, and s3://sets/rain is none: give the path of one, or no claim
        --volume-claim: /data/rain is no folder that a claim at /other can hold
        --volume-claim: /rain is no folder that a claim at / can hold
        ");
        assert!("sets:data".parse::<Claim>().is_err() && ":/data".parse::<Claim>().is_err());
    }
}
