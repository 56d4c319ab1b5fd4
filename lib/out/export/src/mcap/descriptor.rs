//! What readers need to know of a message: a `FileDescriptorSet` with a file for it and each message that it
//! needs.

use std::collections::BTreeSet;

use super::wire::{Described, FieldOf, Message, messages};

messages! {
    /// Files, each after those that it needs.
    FileDescriptorSet in "google.protobuf" { file: Vec<FileDescriptorProto> = 1, }
    /// A file.
    FileDescriptorProto in "google.protobuf" {
        name: String = 1,
        package: String = 2,
        dependency: Vec<Text> = 3,
        message_type: Vec<DescriptorProto> = 4,
        syntax: String = 12,
    }
    /// A message.
    DescriptorProto in "google.protobuf" {
        name: String = 1,
        field: Vec<FieldDescriptorProto> = 2,
        enum_type: Vec<EnumDescriptorProto> = 4,
    }
    /// A field.
    FieldDescriptorProto in "google.protobuf" {
        name: String = 1,
        number: i32 = 3,
        label: i32 = 4,
        r#type: i32 = 5,
        type_name: String = 6,
    }
    /// An enumeration.
    EnumDescriptorProto in "google.protobuf" { name: String = 1, value: Vec<EnumValueDescriptorProto> = 2, }
    /// A value of an enumeration.
    EnumValueDescriptorProto in "google.protobuf" { name: String = 1, number: i32 = 2, }
}

/// A text among several: as bytes the same as a message without key.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Text(String);

impl Message for Text {
    fn describe() -> Described {
        Described { package: "", name: "", fields: Vec::new(), enums: Vec::new() }
    }
    fn encode(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(self.0.as_bytes());
    }
}

/// The name of a type: `foxglove.Pose`.
pub(crate) fn full_name<M: Message>() -> String {
    let described = M::describe();
    format!("{}.{}", described.package, described.name)
}

/// The `FileDescriptorSet` of a message, as bytes.
pub(crate) fn descriptor_set<M: Message>() -> Vec<u8> {
    let (mut files, mut there) = (Vec::new(), BTreeSet::new());
    add(&M::describe(), &mut files, &mut there);
    let mut out = Vec::new();
    FileDescriptorSet { file: files }.encode(&mut out);
    out
}

/// The file of a message: the original's, so that the same type has the same file in every schema.
fn file_of(described: &Described) -> String {
    match described.package {
        "google.protobuf" => format!("google/protobuf/{}.proto", described.name.to_lowercase()),
        package => format!("{package}/{}.proto", described.name),
    }
}

fn add(described: &Described, files: &mut Vec<FileDescriptorProto>, there: &mut BTreeSet<String>) {
    let name = file_of(described);
    if !there.insert(name.clone()) {
        return;
    }
    let mut needed = BTreeSet::new();
    for field in &described.fields {
        if let Some(message) = field.of.message {
            let other = message();
            if file_of(&other) != name {
                add(&other, files, there);
                needed.insert(file_of(&other));
            }
        }
    }
    let enums = described.enums.iter().map(|e| EnumDescriptorProto {
        name: e.name.to_owned(),
        value: e.values.iter().map(|(name, number)| value_of(name, *number)).collect(),
    });
    let message = DescriptorProto {
        name: described.name.to_owned(),
        field: described.fields.iter().map(field_of).collect(),
        enum_type: enums.collect(),
    };
    files.push(FileDescriptorProto {
        name,
        package: described.package.to_owned(),
        dependency: needed.into_iter().map(Text).collect(),
        message_type: vec![message],
        syntax: "proto3".to_owned(),
    });
}

fn value_of(name: &str, number: u32) -> EnumValueDescriptorProto {
    EnumValueDescriptorProto { name: name.to_owned(), number: number as i32 }
}

fn field_of(field: &FieldOf) -> FieldDescriptorProto {
    let type_name = field.of.message.map(|message| {
        let Described { package, name, .. } = message();
        let inner = field.of.enumeration.map_or(String::new(), |e| format!(".{e}"));
        format!(".{package}.{name}{inner}")
    });
    let (optional, repeated) = (1, 3);
    FieldDescriptorProto {
        name: field.name.to_owned(),
        number: field.number as i32,
        label: if field.of.is_repeated { repeated } else { optional },
        r#type: field.of.kind as i32,
        type_name: type_name.unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcap::messages::{PointCloud, SceneUpdate};
    use crate::mcap::wire::Kind;

    fn names<M: Message>() -> Vec<String> {
        let (mut files, mut there) = (Vec::new(), BTreeSet::new());
        add(&M::describe(), &mut files, &mut there);
        files.into_iter().map(|file| file.name).collect()
    }

    #[test]
    fn files_stand_after_those_they_need() {
        assert_eq!(full_name::<PointCloud>(), "foxglove.PointCloud");
        let files = names::<PointCloud>();
        let want = [
            "google/protobuf/timestamp.proto",
            "foxglove/Vector3.proto",
            "foxglove/Quaternion.proto",
            "foxglove/Pose.proto",
            "foxglove/PackedElementField.proto",
            "foxglove/PointCloud.proto",
        ];
        assert_eq!(files, want);
        assert_eq!(names::<SceneUpdate>().last().map(String::as_str), Some("foxglove/SceneUpdate.proto"));
    }

    #[test]
    fn a_field_says_what_it_holds() {
        let fields = PointCloud::describe().fields;
        let pose = field_of(fields.iter().find(|f| f.name == "pose").expect("has one"));
        assert_eq!((pose.number, pose.r#type), (3, Kind::Message as i32));
        assert_eq!((pose.label, pose.type_name.as_str()), (1, ".foxglove.Pose"));
        let described = crate::mcap::messages::PackedElementField::describe();
        let kind = field_of(&described.fields[2]);
        assert_eq!(
            (kind.name.as_str(), kind.r#type, kind.type_name.as_str()),
            ("type", Kind::Enum as i32, ".foxglove.PackedElementField.NumericType")
        );
    }
}
