use alloc::sync::Arc;
use core::net::SocketAddr;
use std::io;
use std::thread::JoinHandle;

use axum::body::Bytes;
use axum::extract::{Path, Request, State, WebSocketUpgrade};
use axum::http::header::{
    CACHE_CONTROL, CONNECTION, CONTENT_SECURITY_POLICY, CONTENT_TYPE, LOCATION,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::middleware::{self, Next};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};
use fga_report::listing;
use fga_report::replay::render_live;
use tokio::sync::oneshot;

use crate::connections::{self, Share};
use crate::guard::{host_allowed, origin_allowed};
use crate::{Catalogue, Live};

/// Threads that read folders.
const BLOCKING_THREADS: usize = 2;
/// Buffer of a WebSocket, bytes: a browser sends nothing but pongs.
const SOCKET_BYTES: usize = 4096;

/// A server with its own thread; dropping it stops it.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Serves a table of runs and their pages. Port 0 takes a free one.
    ///
    /// # Errors
    /// If the server cannot listen on the address.
    pub fn catalogue(address: SocketAddr, catalogue: impl Catalogue) -> io::Result<Self> {
        let router = Router::new()
            .route("/", get(table))
            .route("/replay/{*key}", get(replay))
            .with_state(Arc::new(catalogue) as Arc<dyn Catalogue>);
        Self::start(address, router)
    }

    /// Serves a running flight. Send its events to the returned [`Live`].
    ///
    /// # Errors
    /// If the server cannot listen on the address.
    pub fn live(address: SocketAddr, title: &str) -> io::Result<(Self, Live)> {
        let live = Live::new();
        // Shared by all answers.
        let page = Bytes::from(render_live(title, "/live"));
        let router = Router::new()
            .route("/", get(|| async { Html(page) }))
            .route("/live", get(socket))
            .with_state(live.clone());
        Ok((Self::start(address, router)?, live))
    }

    fn start(address: SocketAddr, router: Router) -> io::Result<Self> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(BLOCKING_THREADS)
            .build()?;
        let listener = {
            let _entered = runtime.enter();
            connections::listen(address)?
        };
        let address = listener.local_addr()?;
        let router = if address.ip().is_loopback() {
            router.layer(middleware::from_fn(named_here))
        } else {
            router
        };
        let router = router.layer(middleware::map_response(with_headers));
        let (stop, stopped) = oneshot::channel();
        let thread = std::thread::Builder::new()
            .name("fga-view".into())
            .spawn(move || {
                runtime.block_on(async {
                    // Stopping does not wait for browsers that keep their connection.
                    tokio::select! {
                        () = connections::serve(listener, router) => {}
                        _ = stopped => {}
                    }
                });
                runtime.shutdown_background();
            })?;
        Ok(Self {
            address,
            stop: Some(stop),
            thread: Some(thread),
        })
    }

    /// The address it listens on.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Serves until the process ends.
    pub fn wait(mut self) {
        if let Some(thread) = self.thread.take() {
            // A panic there has printed its own message.
            let _ = thread.join();
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(stop) = self.stop.take() {
            // The thread may have ended already.
            let _ = stop.send(());
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

async fn named_here(request: Request, next: Next) -> Response {
    if host_allowed(request.headers()) {
        next.run(request).await
    } else {
        (
            StatusCode::FORBIDDEN,
            "this server answers to localhost alone",
        )
            .into_response()
    }
}

async fn with_headers(mut response: Response) -> Response {
    let headers = response.headers_mut();
    headers.insert(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    let same = HeaderValue::from_static("same-origin");
    headers.insert("cross-origin-resource-policy", same);
    if response.status() != StatusCode::SWITCHING_PROTOCOLS {
        // A connection kept for a next request would take another client's room.
        let close = HeaderValue::from_static("close");
        response.headers_mut().insert(CONNECTION, close);
    }
    response
}

type CatalogueState = State<Arc<dyn Catalogue>>;

/// Reading a folder takes time that the other browsers need not wait for.
async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> io::Result<T> + Send + 'static,
) -> Result<T, Response> {
    let failed = |text: String| (StatusCode::INTERNAL_SERVER_ERROR, text).into_response();
    match tokio::task::spawn_blocking(work).await {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(failed(error.to_string())),
        Err(_) => Err(failed("the page could not be made".to_owned())),
    }
}

async fn table(
    State(catalogue): CatalogueState,
    Extension(share): Extension<Arc<Share>>,
) -> Result<Response, Response> {
    share.page().await;
    let page = blocking(move || {
        let mut shown = catalogue.listing()?;
        for row in &mut shown.rows {
            row.link = row.link.as_deref().map(address_of);
        }
        if let [row] = shown.rows.as_slice()
            && let Some(link) = &row.link
        {
            return Ok(Err(link.clone()));
        }
        Ok(Ok(listing::render(&shown)))
    })
    .await?;
    Ok(match page {
        Ok(page) => Html(page).into_response(),
        // A single run needs no table.
        Err(link) => (StatusCode::SEE_OTHER, [(LOCATION, link)]).into_response(),
    })
}

/// The address of a key: characters that are not plain in a path become percent codes.
fn address_of(key: &str) -> String {
    use core::fmt::Write as _;
    let mut address = String::from("/replay/");
    for byte in key.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_.~/".contains(&byte) {
            address.push(char::from(byte));
        } else {
            // Writing to a string does not fail.
            let _ = write!(address, "%{byte:02X}");
        }
    }
    address
}

async fn replay(
    State(catalogue): CatalogueState,
    Extension(share): Extension<Arc<Share>>,
    Path(key): Path<String>,
) -> Result<Response, Response> {
    share.page().await;
    let page = blocking(move || catalogue.page(&key)).await?;
    Ok(match page {
        Some(page) => {
            let html = HeaderValue::from_static("text/html; charset=utf-8");
            let sandbox = HeaderValue::from_static("sandbox allow-scripts");
            let headers = [(CONTENT_TYPE, html), (CONTENT_SECURITY_POLICY, sandbox)];
            (headers, page).into_response()
        }
        None => (StatusCode::NOT_FOUND, "there is no such replay here").into_response(),
    })
}

async fn socket(
    State(live): State<Live>,
    Extension(share): Extension<Arc<Share>>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !origin_allowed(&headers) {
        return (StatusCode::FORBIDDEN, "not a page of this server").into_response();
    }
    upgrade
        .read_buffer_size(SOCKET_BYTES)
        .write_buffer_size(SOCKET_BYTES)
        .max_message_size(SOCKET_BYTES)
        .max_frame_size(SOCKET_BYTES)
        .on_upgrade(async move |socket| {
            live.serve(socket).await;
            drop(share);
        })
}
