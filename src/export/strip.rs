//! Frames of a film as a run leaves them, thinned out when there are too many.

/// Most frames of a film; a longer run leaves steps out.
const FRAMES: usize = 120;

/// Frames of some kind with the step each is of.
#[derive(Debug, Clone)]
pub struct Strip<T> {
    frames: Vec<(u32, T)>,
    /// Steps from frame to frame.
    stride: u32,
}

impl<T> Default for Strip<T> {
    fn default() -> Self {
        Self { frames: Vec::new(), stride: 1 }
    }
}

impl<T> Strip<T> {
    /// Whether a step will be a frame.
    pub fn wants(&self, step: u32) -> bool {
        step.is_multiple_of(self.stride)
    }

    /// Adds a step; when there are more than 120, or `size` says that they weigh more than `most` together, every other
    /// one goes.
    pub fn add(&mut self, step: u32, frame: T, most: usize, size: impl Fn(&T) -> usize) {
        self.frames.push((step, frame));
        let weight: usize = self.frames.iter().map(|(_, frame)| size(frame)).sum();
        if self.frames.len() > FRAMES || (weight > most && self.frames.len() > 2) {
            self.stride *= 2;
            self.frames.retain(|(step, _)| step.is_multiple_of(self.stride));
        }
    }

    /// Adds the end of the run, if it is not there yet.
    pub fn end(&mut self, step: u32, frame: T) {
        if self.frames.last().is_none_or(|(last, _)| *last != step) {
            self.frames.push((step, frame));
        }
    }

    /// All frames, each with its step, rising.
    pub fn frames(&self) -> &[(u32, T)] {
        &self.frames
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_run_keeps_even_steps_and_its_end() {
        let mut strip = Strip::default();
        for step in 0..=301 {
            if strip.wants(step) {
                strip.add(step, (), usize::MAX, |()| 1);
            }
        }
        strip.end(301, ());
        let steps: Vec<u32> = strip.frames().iter().map(|frame| frame.0).collect();
        assert!(steps.len() <= FRAMES + 1 && steps.last() == Some(&301), "{steps:?}");
        assert!(steps.windows(2).all(|pair| pair[1] - pair[0] == 4 || pair[1] == 301), "{steps:?}");

        let mut heavy = Strip::default();
        for step in 0..8 {
            if heavy.wants(step) {
                heavy.add(step, step as usize, 10, |weight| *weight);
            }
        }
        assert!(heavy.frames().iter().map(|frame| frame.1).sum::<usize>() <= 10);
    }
}
