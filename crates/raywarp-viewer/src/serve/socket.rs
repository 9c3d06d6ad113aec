//! A client's WebSocket.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message, WebSocket};
use axum::Error;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use tokio::time::{interval, sleep, timeout, Interval};

use super::client::Client;
use super::connections::Connection;
use super::http::AppState;
use super::input::checked;
use super::outbox::{File, Frame, Outgoing};
use super::protocol::{close as code, FromClient, FromServer, VERSION};
use super::registry::{Admission, ClientRegistry, Ending};
use super::Token;

/// Between two pings.
const PINGS: Duration = Duration::from_secs(2);
/// Before a wrong token is answered, so that guessing takes long.
const HESITATION: Duration = Duration::from_millis(300);
/// For a client to take notice that the connection is closed.
const FAREWELL: Duration = Duration::from_secs(1);
/// What a client without the secret is told.
const REFUSAL: &str =
    "the token is missing or wrong, or the ticket was used: open the last address that the server printed";
/// Longest reason that fits a close frame, in bytes.
const REASON: usize = 120;

type Sink = SplitSink<WebSocket, Message>;
type Stream = SplitStream<WebSocket>;

/// Serves one client until either side has enough. Until it is greeted, its connection may have to make room.
pub async fn serve(socket: WebSocket, state: Arc<AppState>, connection: Arc<Connection>) {
    let (mut sink, mut stream) = socket.split();
    let greeted = tokio::select! {
        greeted = greet(&mut sink, &mut stream, &state) => greeted,
        () = connection.evicted() => return,
    };
    match greeted {
        Ok(admission) => {
            drop(connection);
            let end = attend(&mut sink, &mut stream, &admission.client, &state).await;
            admission.client.leave();
            state.registry.waker.wake();
            part(sink, stream, end).await;
        }
        Err(end) => tokio::select! {
            () = part(sink, stream, end) => {}
            () = connection.evicted() => {}
        },
    }
}

fn ending(code: u16, text: impl Into<String>) -> Option<Ending> {
    Some(Ending { code, text: text.into(), error: true })
}

/// Hears the client's greeting and answers it. Without one, how to part.
async fn greet(sink: &mut Sink, stream: &mut Stream, state: &AppState) -> Result<Admission, Option<Ending>> {
    let first = timeout(state.options.patience.hello, stream.next()).await;
    let first = first.map_err(|_| ending(code::SILENT, "no greeting came in time"))?;
    let text = match first {
        Some(Ok(Message::Text(text))) => text,
        Some(Ok(_)) => return Err(ending(code::UNREADABLE, "the first message must be a greeting: \"hello\"")),
        Some(Err(error)) => return Err(broken(&error)),
        None => return Err(None),
    };
    let Ok(FromClient::Hello { protocol, token, ticket, width, height }) = serde_json::from_str(&text) else {
        return Err(ending(code::UNREADABLE, "the first message must be a greeting: \"hello\""));
    };
    let secret = state.options.token.as_ref().filter(|secret| !secret.is(&token));
    if secret.is_some() && !state.invitations.is_valid(&ticket) {
        sleep(HESITATION).await;
        return Err(ending(code::TOKEN, REFUSAL));
    }
    if protocol != VERSION {
        let _ = sink.send(Message::text(FromServer::hello(None).text())).await;
        let text =
            format!("this server speaks version {VERSION} of the protocol, the page {protocol}: reload the page");
        return Err(ending(code::VERSION, text));
    }
    let full = || {
        let most = state.registry.size();
        ending(code::FULL, format!("all {most} places are taken: try again later"))
    };
    let admission = state.registry.admit([width, height]).ok_or_else(full)?;
    // The last thing: who is refused for another reason keeps the ticket.
    if secret.is_some() && !state.invitations.redeem(&ticket) {
        return Err(ending(code::TOKEN, REFUSAL));
    }
    if sink.send(Message::text(FromServer::hello(secret.map(Token::text)).text())).await.is_err() {
        return Err(None);
    }
    Ok(admission)
}

/// Both directions at once, until one ends; and how to part, if the client is still there to hear it.
async fn attend(sink: &mut Sink, stream: &mut Stream, client: &Client, state: &AppState) -> Option<Ending> {
    let mut told = state.registry.ending();
    let life = Life::default();
    tokio::select! {
        end = listen(stream, client, &state.registry, &life) => end,
        end = speak(sink, client, &life) => end,
        end = watch(&life, state.options.patience.silence) => end,
        end = told.wait_for(Option::is_some) => end.ok().and_then(|end| end.clone()),
    }
}

/// When a client was last heard.
struct Life {
    born: Instant,
    /// In microseconds since then.
    heard: AtomicU64,
}

impl Default for Life {
    fn default() -> Self {
        Self { born: Instant::now(), heard: AtomicU64::new(0) }
    }
}

impl Life {
    fn now(&self) -> u64 {
        self.born.elapsed().as_micros() as u64
    }

    fn sign(&self) {
        self.heard.store(self.now(), Ordering::Relaxed);
    }

    fn silence(&self) -> Duration {
        Duration::from_micros(self.now().saturating_sub(self.heard.load(Ordering::Relaxed)))
    }
}

async fn watch(life: &Life, patience: Duration) -> Option<Ending> {
    loop {
        let left = patience.saturating_sub(life.silence());
        if left.is_zero() {
            return ending(code::SILENT, "nothing was heard from the page");
        }
        sleep(left).await;
    }
}

async fn listen(stream: &mut Stream, client: &Client, registry: &ClientRegistry, life: &Life) -> Option<Ending> {
    while let Some(message) = stream.next().await {
        life.sign();
        let done = match message {
            Ok(Message::Text(text)) => hear(&text, client, life).await,
            Ok(Message::Pong(content)) => {
                pong(&content, client, life);
                ControlFlow::Continue(())
            }
            Ok(Message::Ping(_)) => ControlFlow::Continue(()),
            Ok(Message::Binary(_)) => ControlFlow::Break("messages of clients are text, not binary".to_owned()),
            Ok(Message::Close(_)) => return None,
            Err(error) => return broken(&error),
        };
        if let ControlFlow::Break(text) = done {
            return ending(code::UNREADABLE, text);
        }
        registry.waker.wake();
    }
    None
}

async fn hear(text: &str, client: &Client, life: &Life) -> ControlFlow<String> {
    let message = match serde_json::from_str(text) {
        Ok(message) => message,
        Err(error) => return ControlFlow::Break(format!("a message cannot be read: {error}")),
    };
    match message {
        FromClient::Event { event } => match checked(event) {
            Ok(event) => put(client, event, life).await,
            Err(text) => return ControlFlow::Break(text.to_owned()),
        },
        FromClient::Mark { mark } => client.mark(mark),
        FromClient::Ack { frame } => client.acknowledge(frame),
        FromClient::Received { frame, bytes } => client.received(frame, bytes),
        FromClient::Visible { visible } => client.set_visible(visible),
        FromClient::Hello { .. } => return ControlFlow::Break("a second greeting".to_owned()),
    }
    ControlFlow::Continue(())
}

/// Waits for room; it is not the client's silence meanwhile.
async fn put(client: &Client, event: crate::live::Event, life: &Life) {
    let put = client.input(event);
    tokio::pin!(put);
    while timeout(Duration::from_secs(1), &mut put).await.is_err() {
        life.sign();
    }
}

/// Pings carry the time at which they were sent, in eight bytes, or in four the number of the picture before them. Browsers
/// answer them beside the page, whatever that is at.
fn pong(content: &Bytes, client: &Client, life: &Life) {
    if let Ok(sent) = <[u8; 8]>::try_from(content.as_ref()).map(u64::from_le_bytes) {
        client.pinged(Duration::from_micros(life.now().saturating_sub(sent)));
    } else if let Ok(frame) = <[u8; 4]>::try_from(content.as_ref()).map(u32::from_le_bytes) {
        client.landed(frame);
    }
}

async fn speak(sink: &mut Sink, client: &Client, life: &Life) -> Option<Ending> {
    let mut pings = interval(PINGS);
    loop {
        let message = tokio::select! {
            biased;
            _ = pings.tick() => {
                ping(sink, life).await.ok()?;
                continue;
            }
            message = client.outbox.next() => message,
        };
        let sent = match message {
            Outgoing::Failure(text) => return ending(code::FAILED, text),
            Outgoing::Text(text) => sink.send(Message::text(text)).await,
            Outgoing::File(file) => send_file(sink, file).await,
            Outgoing::Frame(frame) if frame.lossless => send_portions(sink, client, frame, &mut pings, life).await,
            Outgoing::Frame(frame) => send_whole(sink, client, frame).await,
        };
        sent.ok()?;
    }
}

async fn ping(sink: &mut Sink, life: &Life) -> Result<(), Error> {
    sink.send(Message::Ping(Bytes::copy_from_slice(&life.now().to_le_bytes()))).await
}

/// The viewer may make the next one once this one is sent.
async fn send_file(sink: &mut Sink, file: File) -> Result<(), Error> {
    let File { head, content, ticket: _until_sent } = file;
    sink.send(Message::text(head)).await?;
    sink.send(Message::Binary(content)).await
}

async fn send_whole(sink: &mut Sink, client: &Client, frame: Frame) -> Result<(), Error> {
    client.sent(frame.number, frame.stripes.iter().map(Bytes::len).sum());
    for stripe in frame.stripes {
        sink.feed(Message::Binary(stripe)).await?;
    }
    sink.feed(Message::Ping(Bytes::copy_from_slice(&frame.number.to_le_bytes()))).await?;
    sink.flush().await
}

/// Sends no more at a time than arrives in a moment, and stops for a newer picture.
async fn send_portions(
    sink: &mut Sink,
    client: &Client,
    frame: Frame,
    pings: &mut Interval,
    life: &Life,
) -> Result<(), Error> {
    client.sent(frame.number, frame.stripes.iter().map(Bytes::len).sum());
    let mut sent = 0;
    for stripe in frame.stripes {
        loop {
            tokio::select! {
                () = client.wait_for_room(frame.number, sent) => break,
                _ = pings.tick() => ping(sink, life).await?,
            }
        }
        if client.is_old(frame.number) {
            client.abandon(frame.number);
            return Ok(());
        }
        sent += stripe.len() as u64;
        sink.send(Message::Binary(stripe)).await?;
    }
    Ok(())
}

/// How to part from a client whose messages break the rules of WebSocket.
fn broken(error: &Error) -> Option<Ending> {
    let text = error.to_string();
    let code = if text.contains("too long") { code::TOO_LONG } else { code::UNREADABLE };
    ending(code, format!("a message cannot be read: {text}"))
}

/// Says why, if there is somebody to hear it.
async fn part(sink: Sink, stream: Stream, ending: Option<Ending>) {
    if let Some(ending) = ending {
        let _ = timeout(FAREWELL, close(sink, stream, ending)).await;
    }
}

/// Says why, closes, and waits for the client to have heard it.
async fn close(mut sink: Sink, mut stream: Stream, ending: Ending) {
    let end = FromServer::End { text: &ending.text, error: ending.error };
    let _ = sink.feed(Message::text(end.text())).await;
    let mut reason = ending.text;
    while reason.len() > REASON {
        reason.pop();
    }
    let _ = sink.send(Message::Close(Some(CloseFrame { code: ending.code, reason: reason.into() }))).await;
    while let Some(Ok(_)) = stream.next().await {}
}
