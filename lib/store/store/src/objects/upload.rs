//! Objects being written: small ones are one request, larger ones go up in parts while they are encoded.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::Arc;

use object_store::path::Path;
use object_store::{MultipartUpload, ObjectStoreExt, PutPayload};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::JoinHandle;

use super::failure::Failure;
use super::runtime::{start, wait};
use super::service::Service;
use crate::StoreError;
use crate::backend::Sink;

/// Size of a part, bytes: the least that S3 takes. Forty open tables hold one each.
pub(super) const PART: usize = 5 << 20;
/// Parts of all objects of a store that are under way at once.
pub(super) const UNDER_WAY: usize = 8;

/// An object being written.
pub(super) struct Upload {
    service: Arc<Service>,
    path: Path,
    budget: Arc<Semaphore>,
    failed: Box<dyn Fn(Failure) -> StoreError + Send>,
    /// What is in no part yet.
    rest: Vec<u8>,
    parts: Option<Parts>,
}

/// The parts of a larger object.
struct Parts {
    upload: Box<dyn MultipartUpload>,
    under_way: VecDeque<JoinHandle<Result<(), Failure>>>,
    hasher: blake3::Hasher,
    bytes: u64,
}

impl Upload {
    /// Starts an object. `failed` says where it was to be.
    pub(super) fn new(
        service: Arc<Service>,
        path: Path,
        budget: Arc<Semaphore>,
        failed: Box<dyn Fn(Failure) -> StoreError + Send>,
    ) -> Self {
        Self { service, path, budget, failed, rest: Vec::new(), parts: None }
    }

    /// Sends what is in hand as one more part. Waits where too many are under way.
    fn send(&mut self) -> Result<(), Failure> {
        if self.parts.is_none() {
            let (service, path) = (&self.service, &self.path);
            let upload =
                service.wait(async { service.client.put_multipart(path).await.map_err(Failure::from) })?;
            let hasher = blake3::Hasher::new();
            self.parts = Some(Parts { upload, under_way: VecDeque::new(), hasher, bytes: 0 });
        }
        let Some(parts) = &mut self.parts else { return Ok(()) };
        while parts.under_way.front().is_some_and(JoinHandle::is_finished) {
            parts.land()?;
        }
        let budget = Arc::clone(&self.budget);
        let permit: OwnedSemaphorePermit =
            wait(async { budget.acquire_owned().await.map_err(|e| Failure::Away(io::Error::other(e))) })?;
        let part = std::mem::take(&mut self.rest);
        parts.hasher.update(&part);
        parts.bytes += part.len() as u64;
        let request = parts.upload.put_part(PutPayload::from(part));
        let service = Arc::clone(&self.service);
        parts.under_way.push_back(start(async move {
            let answer = service.within(async { request.await.map_err(Failure::from) }).await;
            drop(permit);
            answer
        })?);
        Ok(())
    }

    fn complete(&mut self) -> Result<(), Failure> {
        if self.parts.is_none() {
            let payload = PutPayload::from(std::mem::take(&mut self.rest));
            let (service, path) = (&self.service, &self.path);
            service.wait(async { service.client.put(path, payload).await.map_err(Failure::from) })?;
            return Ok(());
        }
        if !self.rest.is_empty() {
            self.send()?;
        }
        let Some(mut parts) = self.parts.take() else { return Ok(()) };
        let done = parts.land_all().and_then(|()| {
            self.service.wait(async { parts.upload.complete().await.map(drop).map_err(Failure::from) })
        });
        let Err(failure) = done else { return Ok(()) };
        // The answer may be lost after it was done: then the upload is gone, and the object is there.
        if matches!(failure, Failure::Absent | Failure::Away(_)) && self.is_there(&parts) {
            return Ok(());
        }
        self.parts = Some(parts);
        Err(match failure {
            Failure::Absent => Failure::Away(io::Error::other("the upload is gone")),
            other => other,
        })
    }

    /// Whether what was sent is what lies there.
    fn is_there(&self, parts: &Parts) -> bool {
        let (service, path) = (&self.service, &self.path);
        let read = service.wait(async {
            let found = service.client.head(path).await?;
            let mut hasher = blake3::Hasher::new();
            let mut at = 0;
            while at < found.size {
                let end = found.size.min(at + PART as u64);
                hasher.update(&service.client.get_range(path, at..end).await?);
                at = end;
            }
            Ok::<_, Failure>((found.size, hasher.finalize()))
        });
        read.is_ok_and(|there| there == (parts.bytes, parts.hasher.finalize()))
    }
}

impl Parts {
    /// Waits for the first part under way.
    fn land(&mut self) -> Result<(), Failure> {
        let Some(first) = self.under_way.pop_front() else { return Ok(()) };
        wait(async { first.await.map_err(|e| Failure::Away(io::Error::other(e)))? })
    }

    fn land_all(&mut self) -> Result<(), Failure> {
        while !self.under_way.is_empty() {
            self.land()?;
        }
        Ok(())
    }
}

impl Write for Upload {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.rest.len() >= PART {
            self.send().map_err(Failure::into_io)?;
        }
        let taken = bytes.len().min(PART - self.rest.len());
        self.rest.extend_from_slice(&bytes[..taken]);
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Sink for Upload {
    fn commit(mut self: Box<Self>) -> Result<(), StoreError> {
        self.complete().map_err(|failure| (self.failed)(failure))
    }
}

impl Drop for Upload {
    fn drop(&mut self) {
        let Some(mut parts) = self.parts.take() else { return };
        // One that cannot be given up now is for the bucket's rule.
        if self.service.is_away() {
            return;
        }
        let _ = parts.land_all();
        let _ = self.service.wait(async { parts.upload.abort().await.map_err(Failure::from) });
    }
}
