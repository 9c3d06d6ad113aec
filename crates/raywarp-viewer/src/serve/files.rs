//! Makes the files that clients ask for, one after the other, beside the render thread.

use std::sync::mpsc::{channel, Sender};
use std::sync::Arc;

use axum::body::Bytes;

use super::client::Client;
use super::outbox::File;
use super::protocol::{FromServer, Kind};
use crate::live::Export;

/// A thread that makes files. It ends, after the file at hand, when this is dropped.
pub struct Files(Sender<Order>);

/// What to make, and for whom. A viewer has one at a time, so there are never more than viewers.
struct Order {
    client: Arc<Client>,
    export: Export,
}

impl Files {
    pub fn start() -> Self {
        let (sender, orders) = channel();
        std::thread::spawn(move || orders.into_iter().for_each(Order::fulfil));
        Self(sender)
    }

    pub fn order(&self, client: &Arc<Client>, export: Export) {
        // Without the thread, nothing better can be done than to go on.
        let _ = self.0.send(Order { client: Arc::clone(client), export });
    }
}

impl Order {
    fn fulfil(self) {
        let Self { client, export } = self;
        if client.is_gone() {
            return;
        }
        match export.make() {
            Ok(content) => client.outbox.file(file(&export, &content)),
            Err(error) => client.file_failed(error.to_string()),
        }
    }
}

fn file(export: &Export, content: &[u8]) -> File {
    let head = FromServer::File { name: &export.name, media_type: export.media_type, bytes: content.len() }.text();
    let content = Bytes::from([&[Kind::File as u8], content].concat());
    File { head, content, ticket: export.ticket() }
}
