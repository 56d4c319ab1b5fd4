//! The channels of a file: a topic each, with the type of its messages.

use std::collections::BTreeMap;
use std::marker::PhantomData;

use super::chunk::Messages;
use super::clock::time_ns;
use super::container::{Channel, Schema};
use super::descriptor::{descriptor_set, full_name};
use super::wire::Message;
use crate::ExportError;

/// The channels, in the order in which they were asked for, and the schemas of their messages.
#[derive(Debug, Default)]
pub(crate) struct Topics {
    pub(crate) schemas: Vec<Schema>,
    pub(crate) channels: Vec<Channel>,
}

/// A channel of messages of a type.
#[derive(Debug)]
pub(crate) struct Topic<M> {
    number: u16,
    message: PhantomData<fn(M)>,
}

impl Topics {
    /// A new channel. What is known of all its messages can be told with it.
    ///
    /// # Errors
    /// There are more than 65,535.
    pub(crate) fn add<M: Message>(
        &mut self,
        topic: String,
        facts: &[(&str, String)],
    ) -> Result<Topic<M>, ExportError> {
        let name = full_name::<M>();
        let schema = match self.schemas.iter().position(|schema| schema.name == name) {
            Some(there) => there,
            None => {
                self.schemas.push(Schema { name, descriptor: descriptor_set::<M>() });
                self.schemas.len() - 1
            }
        };
        let metadata: BTreeMap<String, String> =
            facts.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
        // There are far fewer types than that.
        self.channels.push(Channel { schema: schema as u16 + 1, topic, metadata });
        let number = u16::try_from(self.channels.len())
            .map_err(|_| ExportError::Refused("a scene has more than 65,535 topics: choose agents".into()))?;
        Ok(Topic { number, message: PhantomData })
    }
}

impl<M: Message> Topic<M> {
    /// Adds a message of a frame.
    pub(crate) fn send(&self, frame: u32, message: &M, out: &mut Messages) {
        out.add(self.number, frame, time_ns(frame), |bytes| message.encode(bytes));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcap::messages::{Imu, Timestamp};

    #[test]
    fn topics_of_a_type_share_its_schema() {
        let mut topics = Topics::default();
        for topic in ["/a", "/b"] {
            topics.add::<Imu>(topic.into(), &[("every_n_frames", "2".into())]).expect("is the first");
        }
        topics.add::<Timestamp>("/c".into(), &[]).expect("is the third");
        assert_eq!(topics.channels.iter().map(|c| c.schema).collect::<Vec<_>>(), [1, 1, 2]);
        assert_eq!(topics.schemas[0].name, "convoy.Imu");
        assert_eq!(topics.channels[1].metadata["every_n_frames"], "2");
    }
}
