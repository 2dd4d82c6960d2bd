//! Drawing: ratatui on top of the screen lease.
//!
//! A frame is collected and leaves in one write, between the marks of a synchronized update. The size comes from the
//! terminal's own descriptor, so a terminal that is gone is an error at once.

use std::{
    cell::RefCell,
    io::{self, Write},
    rc::Rc,
};

use crossterm::{
    queue,
    terminal::{BeginSynchronizedUpdate, EndSynchronizedUpdate},
};
use ratatui::{
    Frame,
    backend::{Backend, ClearType, CrosstermBackend, WindowSize},
    buffer::Cell,
    layout::{Position, Rect, Size},
};

use super::screen::{Screen, ScreenError};

/// The terminal as something to draw on. Dropping it gives the terminal back.
#[derive(Debug)]
pub struct Terminal {
    ratatui: ratatui::Terminal<ScreenBackend>,
    screen: Screen,
}

impl Terminal {
    /// Takes the terminal over.
    ///
    /// # Errors
    ///
    /// When the terminal refuses; it is then as it was found.
    pub fn take(screen: Screen) -> Result<Self, ScreenError> {
        screen.enter()?;
        let ratatui = ratatui::Terminal::new(ScreenBackend::new(screen.clone())).inspect_err(|_| screen.leave())?;
        Ok(Self { ratatui, screen })
    }

    /// Returns the lease.
    pub fn screen(&self) -> &Screen {
        &self.screen
    }

    /// Draws a frame at the terminal's size of this moment. What did not change since the last frame is not sent.
    ///
    /// # Errors
    ///
    /// When the terminal is gone.
    pub fn draw(&mut self, render: impl FnOnce(&mut Frame<'_>)) -> io::Result<()> {
        self.ratatui.draw(render).map(drop)
    }

    /// Makes the next frame paint every cell.
    ///
    /// # Errors
    ///
    /// When the terminal is gone.
    pub fn forget(&mut self) -> io::Result<()> {
        let (width, height) = self.screen.size()?;
        // ratatui's own `clear` asks the terminal where the cursor is and would read the answer from our keyboard.
        self.ratatui.resize(Rect::new(0, 0, width, height))
    }

    /// Takes the terminal over again after a stop; the next frame paints every cell.
    ///
    /// # Errors
    ///
    /// When the terminal is gone.
    pub fn resume(&mut self) -> io::Result<()> {
        self.screen.enter()?;
        self.forget()
    }

    /// Returns how many bytes frames have taken so far.
    pub fn bytes_sent(&self) -> u64 {
        self.ratatui.backend().bytes_sent
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.screen.leave();
    }
}

/// The bytes of the frame being drawn, shared by the writer that collects and the backend that sends them.
#[derive(Clone, Debug, Default)]
struct FrameBytes(Rc<RefCell<Vec<u8>>>);

impl Write for FrameBytes {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    /// Does nothing: crossterm flushes after single commands, a frame leaves as a whole.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// crossterm's backend, with a frame sent in one write and the size asked of the leased terminal.
#[derive(Debug)]
struct ScreenBackend {
    crossterm: CrosstermBackend<FrameBytes>,
    frame: FrameBytes,
    screen: Screen,
    bytes_sent: u64,
}

impl ScreenBackend {
    fn new(screen: Screen) -> Self {
        let frame = FrameBytes::default();
        Self { crossterm: CrosstermBackend::new(frame.clone()), frame, screen, bytes_sent: 0 }
    }
}

impl Backend for ScreenBackend {
    type Error = io::Error;

    fn draw<'a, I: Iterator<Item = (u16, u16, &'a Cell)>>(&mut self, content: I) -> io::Result<()> {
        self.crossterm.draw(content)
    }

    fn hide_cursor(&mut self) -> io::Result<()> {
        self.crossterm.hide_cursor()
    }

    fn show_cursor(&mut self) -> io::Result<()> {
        self.crossterm.show_cursor()
    }

    /// Always fails: asking the terminal would read the answer from under the input thread.
    fn get_cursor_position(&mut self) -> io::Result<Position> {
        Err(io::ErrorKind::Unsupported.into())
    }

    fn set_cursor_position<P: Into<Position>>(&mut self, position: P) -> io::Result<()> {
        self.crossterm.set_cursor_position(position)
    }

    fn clear(&mut self) -> io::Result<()> {
        self.crossterm.clear()
    }

    fn clear_region(&mut self, clear_type: ClearType) -> io::Result<()> {
        self.crossterm.clear_region(clear_type)
    }

    fn size(&self) -> io::Result<Size> {
        self.screen.size().map(Into::into)
    }

    fn window_size(&mut self) -> io::Result<WindowSize> {
        Ok(WindowSize { columns_rows: self.size()?, pixels: Size::default() })
    }

    fn flush(&mut self) -> io::Result<()> {
        let drawn = std::mem::take(&mut *self.frame.0.borrow_mut());
        let mut bytes = Vec::with_capacity(drawn.len() + 16);
        queue!(bytes, BeginSynchronizedUpdate)?;
        bytes.extend_from_slice(&drawn);
        queue!(bytes, EndSynchronizedUpdate)?;
        self.bytes_sent += bytes.len() as u64;
        self.screen.write_frame(&bytes)
    }
}
