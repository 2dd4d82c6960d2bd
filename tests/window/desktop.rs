//! A display of our own, and what a user and a window manager do on it, by X11 requests.

use std::{
    io::{BufRead, BufReader, IoSlice},
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use walkabout::scene::Picture;
use x11rb::{
    connection::{Connection, RequestConnection},
    protocol::xproto::{
        AtomEnum, ClientMessageEvent, ConfigureWindowAux, ConnectionExt, EventMask, ImageFormat, InputFocus, Window,
    },
    rust_connection::RustConnection,
};

/// Longer than anything takes on a busy machine.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// An X server without a screen, and a connection to it.
pub(crate) struct Desktop {
    server: Child,
    number: String,
    connection: RustConnection,
    root: Window,
}

impl Desktop {
    /// Starts the server on a number that is free; the error says what is missing.
    pub(crate) fn start() -> Result<Self, String> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|e| format!("Xvfb does not start ({e}); install xvfb"))?;
        let mut number = String::new();
        let mut output = BufReader::new(server.stdout.take().expect("piped"));
        output.read_line(&mut number).map_err(|e| format!("Xvfb does not say its number: {e}"))?;
        let number = number.trim().to_owned();
        let (connection, screen) =
            x11rb::connect(Some(&format!(":{number}"))).map_err(|e| format!("Xvfb does not answer: {e}"))?;
        let root = connection.setup().roots[screen].root;
        Ok(Self { server, number, connection, root })
    }

    /// The value of `DISPLAY`.
    pub(crate) fn display(&self) -> String {
        format!(":{}", self.number)
    }

    /// Takes the server away.
    pub(crate) fn stop(&mut self) {
        self.server.kill().expect("the server was running");
        self.server.wait().expect("a child can be waited for");
    }

    /// Waits for a window with this title.
    pub(crate) fn window_named(&self, title: &str) -> X11Window<'_> {
        let name = self.atom("_NET_WM_NAME");
        let find = || {
            let children = self.connection.query_tree(self.root).ok()?.reply().ok()?.children;
            children.into_iter().find(|w| {
                let property = self.connection.get_property(false, *w, name, AtomEnum::ANY, 0, 1000);
                property.is_ok_and(|p| p.reply().is_ok_and(|p| p.value == title.as_bytes()))
            })
        };
        let window = eventually(find).unwrap_or_else(|| panic!("no window is called `{title}`"));
        X11Window { desktop: self, window }
    }

    fn atom(&self, name: &str) -> u32 {
        self.connection.intern_atom(false, name.as_bytes()).expect("a connection").reply().expect("an atom").atom
    }

    /// The code of a key by the name of its symbol.
    fn key_code(&self, name: &str) -> u8 {
        let symbol = match name {
            "Shift_L" => 0xFFE1,
            "Control_L" => 0xFFE3,
            "Tab" => 0xFF09,
            "Left" => 0xFF51,
            "space" => 0x20,
            letter => letter.bytes().next().map_or(0, u32::from),
        };
        let setup = self.connection.setup();
        let (first, last) = (setup.min_keycode, setup.max_keycode);
        let request = self.connection.get_keyboard_mapping(first, last - first + 1).expect("a connection");
        let mapping = request.reply().expect("a keyboard");
        let mut codes = mapping.keysyms.chunks(usize::from(mapping.keysyms_per_keycode)).zip(first..);
        codes.find(|(symbols, _)| symbols.contains(&symbol)).map(|(_, code)| code).expect("a key of a keyboard")
    }

    /// Sends what an input device would, by the XTEST extension. Written out, because the feature of x11rb that has it
    /// would compile the window library anew for the tests.
    fn fake_input(&self, kind: u8, detail: u8, x: i16, y: i16) {
        const FAKE_INPUT: u8 = 2;
        const WORDS: u16 = 9;
        let extension = self.connection.extension_information("XTEST").expect("a connection").expect("XTEST");
        let mut request = vec![extension.major_opcode, FAKE_INPUT];
        request.extend(WORDS.to_ne_bytes());
        request.extend([kind, detail, 0, 0]);
        request.extend(0_u32.to_ne_bytes());
        request.extend(self.root.to_ne_bytes());
        request.extend([0; 8]);
        request.extend(x.to_ne_bytes());
        request.extend(y.to_ne_bytes());
        request.extend([0; 8]);
        let sent = self.connection.send_request_without_reply(&[IoSlice::new(&request)], vec![]);
        sent.expect("a connection").check().expect("XTEST is there");
    }
}

impl Drop for Desktop {
    fn drop(&mut self) {
        // Already gone when the test stopped it.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A window of the program under test.
pub(crate) struct X11Window<'a> {
    desktop: &'a Desktop,
    window: Window,
}

impl X11Window<'_> {
    pub(crate) fn resize(&self, width: u32, height: u32) {
        let size = ConfigureWindowAux::new().width(width).height(height);
        self.connection().configure_window(self.window, &size).expect("a connection").check().expect("a window");
    }

    /// Moves the window's top left corner to a place on the screen; what another window covers cannot be photographed.
    pub(crate) fn place(&self, x: i32, y: i32) {
        let place = ConfigureWindowAux::new().x(x).y(y);
        self.connection().configure_window(self.window, &place).expect("a connection").check().expect("a window");
    }

    pub(crate) fn hide(&self) {
        self.connection().unmap_window(self.window).expect("a connection").check().expect("a window");
    }

    pub(crate) fn show(&self) {
        self.connection().map_window(self.window).expect("a connection").check().expect("a window");
    }

    pub(crate) fn focus(&self) {
        let request = self.connection().set_input_focus(InputFocus::PARENT, self.window, x11rb::CURRENT_TIME);
        request.expect("a connection").check().expect("a window that is shown");
    }

    /// Presses keys one after another and releases them in reverse.
    pub(crate) fn press(&self, names: &[&str]) {
        const KEY_PRESS: u8 = 2;
        const KEY_RELEASE: u8 = 3;
        let codes: Vec<u8> = names.iter().map(|n| self.desktop.key_code(n)).collect();
        for code in &codes {
            self.desktop.fake_input(KEY_PRESS, *code, 0, 0);
        }
        for code in codes.iter().rev() {
            self.desktop.fake_input(KEY_RELEASE, *code, 0, 0);
        }
    }

    /// Moves the pointer to a pixel of the window.
    pub(crate) fn point(&self, x: i16, y: i16) {
        const MOTION: u8 = 6;
        let request = self.connection().translate_coordinates(self.window, self.desktop.root, x, y);
        let at = request.expect("a connection").reply().expect("a window");
        self.desktop.fake_input(MOTION, 0, at.dst_x, at.dst_y);
    }

    /// Turns the wheel by a step, away from the user or towards.
    pub(crate) fn wheel(&self, away: bool) {
        let button = if away { 4 } else { 5 };
        for kind in [4, 5] {
            self.desktop.fake_input(kind, button, 0, 0);
        }
    }

    /// Presses or releases the first button.
    pub(crate) fn button(&self, press: bool) {
        self.desktop.fake_input(if press { 4 } else { 5 }, 1, 0, 0);
    }

    /// Asks the window to close, as the button in a title bar does.
    pub(crate) fn close(&self) {
        let (protocols, delete) = (self.desktop.atom("WM_PROTOCOLS"), self.desktop.atom("WM_DELETE_WINDOW"));
        let message = ClientMessageEvent::new(32, self.window, protocols, [delete, x11rb::CURRENT_TIME, 0, 0, 0]);
        let request = self.connection().send_event(false, self.window, EventMask::NO_EVENT, message);
        request.expect("a connection").check().expect("a window");
    }

    /// Waits until what is on the screen is right.
    pub(crate) fn eventually(&self, what: &str, right: impl Fn(&Picture) -> bool) {
        let found = eventually(|| self.screenshot().filter(&right));
        assert!(found.is_some(), "the window never {what}");
    }

    /// What is on the screen; none while the window is not shown.
    pub(crate) fn screenshot(&self) -> Option<Picture> {
        let size = self.connection().get_geometry(self.window).ok()?.reply().ok()?;
        let (width, height) = (size.width, size.height);
        let image = self
            .connection()
            .get_image(ImageFormat::Z_PIXMAP, self.window, 0, 0, width, height, u32::MAX)
            .ok()?
            .reply()
            .ok()?;
        // Four bytes a pixel: blue, green, red and nothing.
        let rgb = image.data.chunks_exact(4).flat_map(|p| [p[2], p[1], p[0]]).collect();
        Some(Picture { width: width.into(), height: height.into(), rgb })
    }

    fn connection(&self) -> &RustConnection {
        &self.desktop.connection
    }
}

/// Tries until there is an answer or patience has ended.
fn eventually<T>(answer: impl Fn() -> Option<T>) -> Option<T> {
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE {
        if let Some(found) = answer() {
            return Some(found);
        }
        thread::sleep(Duration::from_millis(20));
    }
    None
}
