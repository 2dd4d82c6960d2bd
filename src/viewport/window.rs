//! The preview's window: the newest scene in, keys and the pointer out.
//!
//! One winit event loop on the main thread. A small thread waits at the mailbox of scenes and wakes the loop; scenes
//! that come faster than they can be drawn are passed over. Nothing is drawn unless a scene came or the window changed.

use std::{panic, rc::Rc, thread};

use ash::vk;
use raw_window_handle::{HasDisplayHandle, HasWindowHandle};
use winit::{
    application::ApplicationHandler,
    dpi::{LogicalSize, PhysicalPosition},
    error::{EventLoopError, OsError},
    event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent},
    event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy},
    keyboard::ModifiersState,
    window::{Window, WindowId},
};

use super::{
    GpuError, Renderer, RendererOptions, camera,
    device::Device,
    instance::Instance,
    keys,
    surface::Surface,
    swapchain::{Shown, Swapchain},
};
use crate::{
    scene::{FromPreview, MAX_WHEEL_STEPS, Scene},
    sync::Mailbox,
};

/// Size of a new window, in the desktop's units.
const FIRST_SIZE: LogicalSize<f64> = LogicalSize::new(960.0, 600.0);

/// Pixels of a touchpad's travel that count as one step of a wheel.
const PIXELS_PER_STEP: f64 = 40.0;

/// Opens a window and shows the newest scene of the mailbox in it until one of the two is closed.
///
/// Must be called on the main thread, and once in a process. Sends [`FromPreview::Ready`] when the first scene is on the
/// screen, then what the user does. The last event says how it ended: [`FromPreview::Closed`] when the user closed
/// the window, [`FromPreview::Failed`] when there can be no window, in words that say what would help; neither when the
/// mailbox was closed.
///
/// An X server that goes away ends the process, because Xlib does.
pub fn run(title: &str, options: &RendererOptions, scenes: &Mailbox<Scene>, events: impl FnMut(FromPreview)) {
    let mut app = App {
        title,
        options,
        events,
        newest: Mailbox::default(),
        scene: None,
        gpu: None,
        window: None,
        reopened: false,
        ready: false,
        modifiers: ModifiersState::empty(),
        pointer: None,
        pressed_in: None,
        wheel: 0.0,
        ended: false,
    };
    if let Err(why) = app.run(scenes)
        && !app.ended
    {
        (app.events)(FromPreview::Failed(why.to_string()));
    }
}

/// A reason that there is no window.
#[derive(Debug, thiserror::Error)]
enum WindowError {
    #[error("there is no display: neither DISPLAY nor WAYLAND_DISPLAY is set; start on a desktop, or with ssh -X")]
    NoDisplay,
    #[error(
        "the display cannot be opened ({0}); a display server must run, and for X11 the libraries libxcursor1, libxi6 \
         and libxkbcommon-x11-0 be installed"
    )]
    NoServer(String),
    #[error("the keyboard cannot be read; install libxkbcommon-x11-0 ({0})")]
    NoKeyboard(String),
    #[error("the display refused a window ({0})")]
    NoWindow(String),
    #[error("the display server went away ({0})")]
    ServerGone(String),
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// What wakes the loop from outside.
#[derive(Clone, Copy, Debug)]
enum Wake {
    Scene,
    Close,
}

/// The state of the window. Fields are dropped in order: what draws goes before the window it draws on.
struct App<'a, E> {
    title: &'a str,
    options: &'a RendererOptions,
    events: E,
    /// Where the loop finds the newest scene.
    newest: Mailbox<Scene>,
    /// What is shown.
    scene: Option<Scene>,
    gpu: Option<Gpu>,
    window: Option<Rc<Window>>,
    /// A lost device was opened anew.
    reopened: bool,
    /// The first scene was shown.
    ready: bool,
    modifiers: ModifiersState,
    pointer: Option<PhysicalPosition<f64>>,
    /// The view in which the button went down.
    pressed_in: Option<u32>,
    /// Turns of the wheel that do not yet make a step.
    wheel: f64,
    /// The last event was sent.
    ended: bool,
}

impl<E: FnMut(FromPreview)> App<'_, E> {
    fn run(&mut self, scenes: &Mailbox<Scene>) -> Result<(), WindowError> {
        let event_loop = open_display()?;
        event_loop.set_control_flow(ControlFlow::Wait);
        let (scenes, newest, proxy) = (scenes.clone(), self.newest.clone(), event_loop.create_proxy());
        // Ends when the mailbox is closed or the loop is gone; nobody waits for it.
        thread::spawn(move || forward(&scenes, &newest, &proxy));
        event_loop.run_app(self).map_err(|e| WindowError::ServerGone(reason(&e)))
    }

    /// Ends the loop with a last event.
    fn end(&mut self, event_loop: &ActiveEventLoop, last: FromPreview) {
        if !self.ended {
            self.ended = true;
            (self.events)(last);
        }
        event_loop.exit();
    }

    fn open(&mut self, event_loop: &ActiveEventLoop) -> Result<(), WindowError> {
        let attributes = Window::default_attributes().with_title(self.title).with_inner_size(FIRST_SIZE);
        let window = event_loop.create_window(attributes).map_err(|e| WindowError::NoWindow(os_reason(&e)))?;
        let window = Rc::new(window);
        self.gpu = Some(Gpu::new(&window, self.options)?);
        self.window = Some(window);
        Ok(())
    }

    /// Draws the newest scene, if the window can be drawn on.
    fn draw(&mut self) -> Result<(), WindowError> {
        self.scene = self.newest.take().or(self.scene.take());
        let (Some(window), Some(scene), Some(gpu)) = (&self.window, &self.scene, &mut self.gpu) else {
            return Ok(());
        };
        match gpu.show(scene) {
            Ok(Shown::Yes) if !self.ready => {
                self.ready = true;
                let (device, driver) = (gpu.renderer.device_name(), gpu.renderer.driver().to_owned());
                (self.events)(FromPreview::Ready { device, driver });
            }
            Ok(Shown::Yes | Shown::NoArea) => {}
            Ok(Shown::Again) => window.request_redraw(),
            Err(GpuError::DeviceLost | GpuError::SurfaceLost) if !self.reopened => {
                self.reopened = true;
                // A window has one surface at a time, so the old one goes first.
                self.gpu = None;
                self.gpu = Some(Gpu::new(window, self.options)?);
                window.request_redraw();
            }
            Err(other) => return Err(other.into()),
        }
        Ok(())
    }

    /// Answers the pointer's button.
    fn button(&mut self, state: ElementState) {
        let (Some(scene), Some(window), Some(at)) = (&self.scene, &self.window, self.pointer) else { return };
        let size = window.inner_size();
        if state == ElementState::Pressed {
            if let Some(ray) = camera::pick(&scene.now.views, size.width, size.height, at.x, at.y) {
                self.pressed_in = Some(ray.view);
                (self.events)(FromPreview::Pick(ray));
            }
        } else if self.pressed_in.take().is_some() {
            (self.events)(FromPreview::Release);
        }
    }

    /// Answers the pointer's motion.
    fn motion(&mut self, at: PhysicalPosition<f64>) {
        self.pointer = Some(at);
        let (Some(scene), Some(window), Some(view)) = (&self.scene, &self.window, self.pressed_in) else { return };
        let size = window.inner_size();
        let ray = camera::ray_through(&scene.now.views, view as usize, size.width, size.height, at.x, at.y);
        if let Some(ray) = ray {
            (self.events)(FromPreview::Drag(ray));
        }
    }

    /// Answers the pointer's wheel: whole steps are told, what is left is kept.
    fn wheel(&mut self, delta: MouseScrollDelta) {
        self.wheel += match delta {
            MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
            MouseScrollDelta::PixelDelta(by) => by.y / PIXELS_PER_STEP,
        };
        let steps = self.wheel.trunc();
        self.wheel -= steps;
        let steps = (steps as i32).clamp(-MAX_WHEEL_STEPS, MAX_WHEEL_STEPS);
        let (Some(scene), Some(window), Some(at)) = (&self.scene, &self.window, self.pointer) else { return };
        let size = window.inner_size();
        if steps != 0
            && let Some(ray) = camera::pick(&scene.now.views, size.width, size.height, at.x, at.y)
        {
            (self.events)(FromPreview::Wheel { view: ray.view, steps });
        }
    }

    fn request_redraw(&self) {
        if let Some(window) = &self.window {
            window.request_redraw();
        }
    }
}

impl<E: FnMut(FromPreview)> ApplicationHandler<Wake> for App<'_, E> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.window.is_none()
            && let Err(why) = self.open(event_loop)
        {
            self.end(event_loop, FromPreview::Failed(why.to_string()));
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, wake: Wake) {
        match wake {
            Wake::Scene => self.request_redraw(),
            Wake::Close => {
                self.ended = true;
                event_loop.exit();
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::RedrawRequested => {
                if let Err(why) = self.draw() {
                    self.end(event_loop, FromPreview::Failed(why.to_string()));
                }
            }
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } | WindowEvent::Occluded(false) => {
                self.request_redraw();
            }
            WindowEvent::CloseRequested | WindowEvent::Destroyed => self.end(event_loop, FromPreview::Closed),
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::KeyboardInput { event, is_synthetic: false, .. } if event.state == ElementState::Pressed => {
                if let Some(key) = keys::key(&event.logical_key, self.modifiers) {
                    (self.events)(FromPreview::Key(key));
                }
            }
            WindowEvent::CursorMoved { position, .. } => self.motion(position),
            WindowEvent::MouseWheel { delta, .. } => self.wheel(delta),
            WindowEvent::MouseInput { state, button: MouseButton::Left, .. } => self.button(state),
            _ => {}
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        // While the display is still there.
        self.gpu = None;
        self.window = None;
    }
}

/// What draws on one window; the swapchain goes first, because its frame is the renderer's.
struct Gpu {
    swapchain: Swapchain,
    renderer: Renderer,
    /// The surface must not outlive it.
    window: Rc<Window>,
}

impl Gpu {
    fn new(window: &Rc<Window>, options: &RendererOptions) -> Result<Self, WindowError> {
        let gone = |e: raw_window_handle::HandleError| WindowError::NoWindow(e.to_string());
        let display = window.display_handle().map_err(gone)?.as_raw();
        let handle = window.window_handle().map_err(gone)?.as_raw();
        let extensions = ash_window::enumerate_required_extensions(display)
            .map_err(|result| GpuError::Failed { what: "draw on this display", result })?;
        let instance = Instance::new(extensions, options.validation.as_ref())?;
        // SAFETY: display and window live as long as the `Rc` that is kept beside the surface, in `Gpu::window`, which
        // is dropped after it.
        let surface = unsafe { Surface::new(&instance, display, handle) }?;
        let device = Device::new(instance, options.device, Some(&surface))?;
        let renderer = Renderer::on_device(Rc::clone(&device), options.quality)?;
        Ok(Self { swapchain: Swapchain::new(&device, surface), renderer, window: Rc::clone(window) })
    }

    fn show(&mut self, scene: &Scene) -> Result<Shown, GpuError> {
        let size = self.window.inner_size();
        let extent = vk::Extent2D { width: size.width, height: size.height };
        self.swapchain.show(&mut self.renderer, scene, extent, || self.window.pre_present_notify())
    }
}

/// Hands scenes to the loop, the newest only, and wakes it.
fn forward(scenes: &Mailbox<Scene>, newest: &Mailbox<Scene>, proxy: &EventLoopProxy<Wake>) {
    while let Some(scene) = scenes.wait() {
        // When the last one was never taken, the loop has been woken for it already.
        let waiting = newest.put(scene).is_some();
        if !waiting && proxy.send_event(Wake::Scene).is_err() {
            return;
        }
    }
    // An error means that the loop has ended by itself.
    let _ = proxy.send_event(Wake::Close);
}

fn open_display() -> Result<EventLoop<Wake>, WindowError> {
    let unix = cfg!(all(unix, not(target_os = "macos")));
    if unix && ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].iter().all(|v| std::env::var_os(v).is_none()) {
        return Err(WindowError::NoDisplay);
    }
    // winit panics when libxkbcommon-x11 is missing; the panic hook stays quiet, since this is an answer like others.
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let built = panic::catch_unwind(|| EventLoop::<Wake>::with_user_event().build());
    panic::set_hook(hook);
    match built {
        Ok(built) => built.map_err(|e| WindowError::NoServer(reason(&e))),
        Err(panicked) => Err(WindowError::NoKeyboard(panic_text(panicked.as_ref()))),
    }
}

/// The reason within winit's error, without the place in winit's source.
fn reason(error: &EventLoopError) -> String {
    match error {
        EventLoopError::Os(error) => os_reason(error),
        other => other.to_string(),
    }
}

fn os_reason(error: &OsError) -> String {
    let text = error.to_string();
    // `os error at FILE:LINE: REASON`
    text.split_once(": ").map_or(text.clone(), |(_, reason)| reason.to_owned())
}

fn panic_text(panicked: &(dyn std::any::Any + Send)) -> String {
    let text = panicked.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panicked.downcast_ref::<&str>().copied()).unwrap_or("no reason given").replace('\n', " ")
}
