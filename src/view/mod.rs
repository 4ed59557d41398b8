//! A live page that shows target, drawing and residual side by side, during a fit and after it.
//!
//! [`Viewer::open`] serves the page from this process, on the loopback interface only, at a random port. Its
//! path begins with a random token that only the [address](Viewer::address) contains. The page loads nothing
//! from elsewhere. Requests for another `Host` are refused, so that no foreign page can reach the server
//! through a name that resolves to this machine.
//!
//! [`Viewer::watch`] wraps a fit's observer and passes what it sees to the page. It copies the drawing only
//! while a page asks for it, and at most four times a second.
//!
//! ```
//! use strokefit::fit::{Budget, Config, Fitter};
//! use strokefit::image::Image;
//! use strokefit::view::Viewer;
//!
//! let picture = Image::filled(32, 32, [0.8, 0.2, 0.1])?;
//! let viewer = Viewer::open()?;
//! println!("see {}", viewer.address());
//! viewer.begin("a red page", Some(&picture))?;
//! let config = Config { budget: Budget { strokes: Some(8), ..Budget::default() }, ..Config::default() };
//! let drawing = Fitter::new(config).observer(&mut viewer.watch(&mut ())).fit(&picture)?;
//! viewer.show(&drawing.scene, "<svg/>");
//! // viewer.wait() stays until the page wants something, or nothing more.
//! # Ok::<(), strokefit::Error>(())
//! ```

mod http;
mod page;
mod server;
mod shared;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Duration;

use crate::error::{Error, ErrorKind, Result};
use crate::fit::{Observer, Progress};
use crate::image::Image;
use crate::scene::Scene;
use server::Server;
use shared::Shared;

/// Time that [`Viewer::wait`] waits without a request from the page. Browsers let a page in the background ask at least
/// once a minute.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Longest side of the target that is sent to the page, px.
const MAX_SIDE: usize = 2048;

/// A page that is being served. It is gone when this is dropped.
pub struct Viewer {
    server: Server,
    shared: Arc<Shared>,
}

impl Viewer {
    /// Serves a page that shows nothing yet.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when the system gives no port or no random numbers.
    pub fn open() -> Result<Self> {
        let shared = Arc::new(Shared::new());
        let server = Server::start(Arc::clone(&shared)).map_err(|e| {
            let message = format!("the live page cannot be served: {e}: run without --view");
            Error::new(ErrorKind::Io, message).caused_by(e)
        })?;
        Ok(Self { server, shared })
    }

    /// Turns to another drawing, called `title`, of `target` if there is one; its alpha is laid on white.
    ///
    /// # Errors
    /// [`ErrorKind::Picture`] as [`Image::encode_png`].
    pub fn begin(&self, title: &str, target: Option<&Image>) -> Result<()> {
        let target = target.map(|target| reduced(target).encode_png());
        self.shared.begin(title, target.transpose()?);
        Ok(())
    }

    /// Where the page is, for a browser on this machine.
    pub fn address(&self) -> String {
        self.server.address()
    }

    /// An observer that tells the page and `inner`, and stops the fit when either wants to.
    pub fn watch<'a>(
        &'a self,
        inner: &'a mut (dyn Observer + Send),
    ) -> impl FnMut(&Progress<'_>) -> ControlFlow<()> + Send + 'a {
        |progress: &Progress<'_>| {
            inner.observe(progress)?;
            if self.shared.note(progress) {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        }
    }

    /// Shows a finished drawing; `svg` is its file.
    pub fn show(&self, scene: &Scene, svg: &str) {
        self.shared.finish(scene.clone(), svg.to_owned());
    }

    /// Lets the page ask for more strokes, or not, which is what it starts with.
    pub fn offer_more(&self, offered: bool) {
        self.shared.offer_more(offered);
    }

    /// Stays until the page asks for more strokes, and returns how many, or until it says that it is done
    /// or no page has been heard of for [`PATIENCE`].
    pub fn wait(&self) -> Option<usize> {
        self.shared.wait(PATIENCE)
    }
}

/// The target at a size for a screen.
fn reduced(target: &Image) -> Image {
    let mut image = target.flattened([1.0; 3]);
    while image.width().max(image.height()) > MAX_SIDE {
        image = image.halved();
    }
    image
}
