//! Connections, the files of the page, and the way to the WebSocket.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::Extension;
use axum::extract::{State, WebSocketUpgrade};
use axum::http::{header, HeaderMap, Method, StatusCode, Uri};
use axum::response::{IntoResponse, Response};
use axum::routing::any;
use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::time::{sleep, timeout};

use super::address::is_own;
use super::connections::{Connection, Connections};
use super::invitations::Invitations;
use super::protocol::MAX_MESSAGE;
use super::registry::ClientRegistry;
use super::{socket, Patience, ServeOptions};

/// Headers of a request, in bytes.
const MAX_HEAD: usize = 16 << 10;
/// What is read of a WebSocket at once, in bytes. Clients write little.
const READ: usize = 8 << 10;

/// The page's own files and nothing else; no other page may frame it.
const POLICY: &str =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src data: blob:; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
const PLAIN: &str = "text/plain; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// The page: path, media type, content.
const FILES: [(&str, &str, &str); 10] = [
    ("/", "text/html; charset=utf-8", include_str!("page/index.html")),
    ("/style.css", "text/css; charset=utf-8", include_str!("page/style.css")),
    ("/viewer.js", SCRIPT, include_str!("page/viewer.js")),
    ("/input.js", SCRIPT, include_str!("page/input.js")),
    ("/link.js", SCRIPT, include_str!("page/link.js")),
    ("/panel.js", SCRIPT, include_str!("page/panel.js")),
    ("/picture.js", SCRIPT, include_str!("page/picture.js")),
    ("/secret.js", SCRIPT, include_str!("page/secret.js")),
    ("/stats.js", SCRIPT, include_str!("page/stats.js")),
    ("/words.js", SCRIPT, include_str!("page/words.js")),
];

/// What every request needs.
#[derive(Debug)]
pub struct AppState {
    pub registry: Arc<ClientRegistry>,
    pub options: ServeOptions,
    pub invitations: Arc<Invitations>,
    connections: Arc<Connections>,
}

impl AppState {
    pub fn new(registry: Arc<ClientRegistry>, options: ServeOptions, invitations: Arc<Invitations>) -> Self {
        let connections = Connections::new(options.connections);
        Self { registry, options, invitations, connections }
    }
}

/// Takes connections for ever, as soon as they come.
pub async fn listen(listener: TcpListener, state: Arc<AppState>) {
    let router = Router::new().route("/live", any(live)).fallback(page).with_state(Arc::clone(&state));
    loop {
        match listener.accept().await {
            Ok((stream, from)) => {
                let connection = Arc::new(state.connections.enter(from.ip()));
                let router = router.clone().layer(Extension(Arc::clone(&connection)));
                tokio::spawn(answer(stream, router, state.options.patience, connection));
            }
            // Too many open files, most likely.
            Err(_) => {
                state.connections.evict();
                sleep(Duration::from_millis(10)).await;
            }
        }
    }
}

/// Answers the requests of a connection until it becomes a WebSocket, its time is over, or another needs its place.
async fn answer(stream: TcpStream, router: Router, patience: Patience, connection: Arc<Connection>) {
    let _ = stream.set_nodelay(true);
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(patience.head).max_buf_size(MAX_HEAD);
    let requests = builder.serve_connection(TokioIo::new(stream), TowerToHyperService::new(router)).with_upgrades();
    tokio::select! {
        _ = timeout(patience.request, requests) => {}
        () = connection.evicted() => {}
    }
}

/// Refuses what other pages, or this one under a foreign name, ask for.
fn check(headers: &HeaderMap, state: &AppState) -> Result<(), Box<Response>> {
    let text = |name| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
    if is_own(text(header::HOST), text(header::ORIGIN), state.options.token.is_some()) {
        return Ok(());
    }
    let sentence = "This request comes from another page, or under a name that is not this server's. Open the address \
                    that the server printed; under another name it answers only where it has a token.\n";
    Err(Box::new(reply(StatusCode::FORBIDDEN, PLAIN, sentence)))
}

async fn page(
    State(state): State<Arc<AppState>>,
    Extension(connection): Extension<Arc<Connection>>,
    method: Method,
    uri: Uri,
    headers: HeaderMap,
) -> Response {
    connection.touch();
    if let Err(refusal) = check(&headers, &state) {
        return *refusal;
    }
    if method != Method::GET && method != Method::HEAD {
        return reply(StatusCode::METHOD_NOT_ALLOWED, PLAIN, "Only GET is answered here.\n");
    }
    match FILES.iter().find(|(path, ..)| *path == uri.path()) {
        Some((_, kind, content)) => reply(StatusCode::OK, kind, content),
        None => reply(StatusCode::NOT_FOUND, PLAIN, "There is only one page here: /\n"),
    }
}

async fn live(
    State(state): State<Arc<AppState>>,
    Extension(connection): Extension<Arc<Connection>>,
    headers: HeaderMap,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Response {
    connection.touch();
    if let Err(refusal) = check(&headers, &state) {
        return *refusal;
    }
    let upgrade = match upgrade {
        Ok(upgrade) => upgrade,
        Err(rejection) => return rejection.into_response(),
    };
    let upgrade = upgrade.max_message_size(MAX_MESSAGE).max_frame_size(MAX_MESSAGE).read_buffer_size(READ);
    upgrade.on_upgrade(move |socket| socket::serve(socket, state, connection))
}

fn reply(status: StatusCode, kind: &'static str, body: &'static str) -> Response {
    let headers = [
        (header::CONTENT_TYPE, kind),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        // A page from before an update would speak to the server of after.
        (header::CACHE_CONTROL, "no-cache"),
    ];
    (status, headers, body).into_response()
}
