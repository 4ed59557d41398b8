//! The server: accepts connections, checks where requests come from, and answers them.

use std::io;
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use super::http::{Request, Response};
use super::page;
use super::shared::{Shared, Wish};

/// Most connections at once; a browser opens six.
const MAX_CONNECTIONS: usize = 32;
/// Most strokes that a page may ask for at once.
const MAX_MORE: usize = 100_000;
/// Time that a connection may be idle.
const TIMEOUT: Duration = Duration::from_secs(5);

/// A server on a thread of its own, gone when this is dropped.
pub(super) struct Server {
    socket: SocketAddr,
    token: String,
    closing: Arc<AtomicBool>,
}

impl Server {
    pub(super) fn start(shared: Arc<Shared>) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        let server = Self {
            socket: listener.local_addr()?,
            token: token()?,
            closing: Arc::default(),
        };
        let desk = Arc::new(Desk {
            host: server.socket.to_string(),
            root: format!("/{}/", server.token),
            shared,
            connections: AtomicUsize::new(0),
        });
        let closing = Arc::clone(&server.closing);
        let name = "page".to_owned();
        thread::Builder::new()
            .name(name)
            .spawn(move || listen(&listener, &desk, &closing))?;
        Ok(server)
    }

    pub(super) fn address(&self) -> String {
        format!("http://{}/{}/", self.socket, self.token)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::Release);
        // A connection wakes the listener, which then sees that it is to end.
        drop(TcpStream::connect(self.socket));
    }
}

/// 128 random bits in hexadecimal.
fn token() -> io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn listen(listener: &TcpListener, desk: &Arc<Desk>, closing: &AtomicBool) {
    for stream in listener.incoming() {
        if closing.load(Ordering::Acquire) {
            return;
        }
        let Ok(stream) = stream else { continue };
        if desk.connections.fetch_add(1, Ordering::Relaxed) >= MAX_CONNECTIONS {
            desk.connections.fetch_sub(1, Ordering::Relaxed);
            continue;
        }
        let own = Arc::clone(desk);
        let answer = move || {
            // The page may have gone; then nobody misses the answer.
            let _ = own.serve(stream);
            own.connections.fetch_sub(1, Ordering::Relaxed);
        };
        if thread::Builder::new().spawn(answer).is_err() {
            desk.connections.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

/// Side of the server that answers requests.
struct Desk {
    host: String,
    /// Start of every path.
    root: String,
    shared: Arc<Shared>,
    connections: AtomicUsize,
}

impl Desk {
    fn serve(&self, mut stream: TcpStream) -> io::Result<()> {
        stream.set_read_timeout(Some(TIMEOUT))?;
        stream.set_write_timeout(Some(TIMEOUT))?;
        let Some(request) = Request::read(&mut stream)? else {
            return Response::refusal("400 Bad Request").write(&mut stream);
        };
        let (response, wish) = self.answer(&request);
        let written = response.write(&mut stream);
        let _ = stream.shutdown(Shutdown::Write);
        // After the answer: the program may end then.
        if let Some(wish) = wish {
            self.shared.wish(wish);
        }
        written
    }

    fn answer(&self, request: &Request) -> (Response, Option<Wish>) {
        // A foreign page can make a name of its own resolve to this machine, but the browser then sends
        // that name.
        if request.host.as_deref() != Some(&self.host) {
            return (Response::refusal("421 Misdirected Request"), None);
        }
        let own = format!("http://{}", self.host);
        let foreign = request.origin.as_ref().is_some_and(|origin| *origin != own);
        let Some(name) = request.path.strip_prefix(&self.root).filter(|_| !foreign) else {
            return (Response::refusal("404 Not Found"), None);
        };
        if request.method == "GET" {
            return (self.resource(name, request), None);
        }
        let wish = match (&*request.method, name) {
            ("POST", "stop") => Wish::Stop,
            ("POST", "done") => Wish::Leave,
            ("POST", "more") => match strokes(request) {
                Some(strokes) => Wish::More(strokes),
                None => return (Response::refusal("400 Bad Request"), None),
            },
            _ => return (Response::refusal("405 Method Not Allowed"), None),
        };
        let noted = Response::of("text/plain", b"".as_slice());
        (noted, Some(wish))
    }

    fn resource(&self, name: &str, request: &Request) -> Response {
        let shared = &self.shared;
        let svg = || shared.svg().map(|svg| svg.as_bytes().to_vec());
        let resource = match name {
            "target.png" => shared.target().map(|png| Response::of("image/png", png)),
            "drawing.svg" => {
                svg().map(|svg| Response::of("image/svg+xml", svg).saved_as("drawing.svg"))
            }
            "state" => page::state(shared, request.number("seen"))
                .map(|json| Response::of("application/json", json)),
            _ => page::file(name),
        };
        resource.unwrap_or(Response::refusal("404 Not Found"))
    }
}

/// Number of further strokes that are asked for.
fn strokes(request: &Request) -> Option<usize> {
    let strokes = usize::try_from(request.number("strokes")?).ok()?;
    (1..=MAX_MORE).contains(&strokes).then_some(strokes)
}
