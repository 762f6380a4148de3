//! Plots: lines and filled shapes over two axes, as pictures.

use bevy::math::{Vec2, ops};
use image::{Rgb, RgbImage};

use super::canvas::{INK, PAPER, text_size, write_text};

/// Colours of the lines of a plot, in order.
pub const COLORS: [[u8; 3]; 8] = [
    [36, 92, 148],
    [196, 82, 40],
    [58, 130, 66],
    [138, 74, 150],
    [176, 140, 30],
    [40, 140, 150],
    [150, 60, 80],
    [90, 90, 90],
];

/// A line of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Its name in the legend; empty for none.
    pub name: String,
    /// Its points.
    pub points: Vec<Vec2>,
    /// Its colour.
    pub color: [u8; 3],
    /// Its width, pixels.
    pub width: f32,
}

/// A filled shape of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its corners, in order; it must be convex.
    pub corners: Vec<Vec2>,
    /// Its colour.
    pub color: [u8; 3],
}

/// Lines and shapes over two axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// What runs to the right.
    pub x: String,
    /// What runs up.
    pub y: String,
    /// Whether a unit is as long on both axes.
    pub equal: bool,
    /// Shapes, drawn first.
    pub shapes: Vec<Shape>,
    /// Lines.
    pub lines: Vec<Line>,
}

impl Plot {
    /// An empty plot.
    pub fn new(title: &str, x: &str, y: &str) -> Self {
        Self { title: title.into(), x: x.into(), y: y.into(), ..Self::default() }
    }

    /// The same with equal units on both axes: for the shapes of things.
    pub fn of_shapes(title: &str, x: &str, y: &str) -> Self {
        Self { equal: true, ..Self::new(title, x, y) }
    }

    /// Adds a line in the next colour.
    pub fn line(&mut self, name: impl Into<String>, points: impl IntoIterator<Item = Vec2>) {
        let color = COLORS[self.lines.len() % COLORS.len()];
        self.lines.push(Line { name: name.into(), points: points.into_iter().collect(), color, width: 1.6 });
    }

    /// Draws it. Points that are not finite are left out; a plot of nothing has axes from 0 to 1.
    pub fn draw(&self, width: u32, height: u32) -> RgbImage {
        let mut image = RgbImage::from_pixel(width.max(80), height.max(60), Rgb(PAPER));
        let (w, h) = (image.width() as f32, image.height() as f32);
        // The legend has a margin of its own, so that no line runs through it.
        let named: Vec<&Line> = self.lines.iter().filter(|line| !line.name.is_empty()).collect();
        let widest = named.iter().map(|line| text_size(&line.name, 1).0).max();
        let legend = widest.map_or(0.0, |widest| (widest as f32 + 32.0).min(0.5 * w));
        let frame = Frame::new(self, [52.0, w - 14.0 - legend], [h - 36.0, 26.0]);
        for step in frame.ticks(0) {
            let x = frame.at(Vec2::new(step, frame.low.y)).x;
            segment(&mut image, Vec2::new(x, frame.bottom), Vec2::new(x, frame.top), [226, 222, 212], 1.0);
            let text = number(step);
            let left = x as i64 - i64::from(text_size(&text, 1).0 / 2);
            plain(&mut image, left, frame.bottom as i64 + 5, &text);
        }
        for step in frame.ticks(1) {
            let y = frame.at(Vec2::new(frame.low.x, step)).y;
            segment(&mut image, Vec2::new(frame.left, y), Vec2::new(frame.right, y), [226, 222, 212], 1.0);
            let text = number(step);
            plain(&mut image, frame.left as i64 - 5 - i64::from(text_size(&text, 1).0), y as i64 - 4, &text);
        }
        for shape in &self.shapes {
            let corners: Vec<Vec2> = shape.corners.iter().map(|p| frame.at(*p)).collect();
            fill(&mut image, &corners, shape.color);
        }
        for line in &self.lines {
            for ends in line.points.windows(2).filter(|ends| ends.iter().all(|p| p.is_finite())) {
                segment(&mut image, frame.at(ends[0]), frame.at(ends[1]), line.color, line.width);
            }
        }
        plain(&mut image, frame.left as i64, 8, &self.title);
        let end = frame.right as i64 - i64::from(text_size(&self.x, 1).0);
        plain(&mut image, end, h as i64 - 14, &self.x);
        if !self.y.is_empty() {
            plain(&mut image, 4, h as i64 - 14, &format!("up: {}", self.y));
        }
        for (k, line) in named.iter().enumerate() {
            let (x, y) = (frame.right + 10.0, frame.top + 8.0 + 12.0 * k as f32);
            segment(&mut image, Vec2::new(x, y), Vec2::new(x + 18.0, y), line.color, 2.4);
            plain(&mut image, x as i64 + 23, y as i64 - 4, &line.name);
        }
        image
    }
}

/// Writing without a shadow: on paper none is needed.
fn plain(image: &mut RgbImage, x: i64, y: i64, text: &str) {
    write_text(image, x, y, text, 1, INK);
}

/// A number with as many digits as it needs.
fn number(x: f32) -> String {
    let text = format!("{x:.3}");
    text.trim_end_matches('0').trim_end_matches('.').replace("-0", if x == 0.0 { "0" } else { "-0" })
}

/// Where the axes lie in the picture.
struct Frame {
    left: f32,
    right: f32,
    bottom: f32,
    top: f32,
    low: Vec2,
    high: Vec2,
}

impl Frame {
    fn new(plot: &Plot, [left, right]: [f32; 2], [bottom, top]: [f32; 2]) -> Self {
        let points =
            plot.lines.iter().flat_map(|l| &l.points).chain(plot.shapes.iter().flat_map(|s| &s.corners));
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for point in points.filter(|p| p.is_finite()) {
            low = low.min(*point);
            high = high.max(*point);
        }
        if !(low.is_finite() && high.is_finite()) {
            (low, high) = (Vec2::ZERO, Vec2::ONE);
        }
        let mut size = (high - low).max(Vec2::splat(1e-6));
        let room = Vec2::new(right - left, bottom - top);
        if plot.equal {
            let scale = (size / room).max_element();
            size = room * scale;
        }
        let middle = (low + high) * 0.5;
        Self { left, right, bottom, top, low: middle - size * 0.53, high: middle + size * 0.53 }
    }

    fn at(&self, point: Vec2) -> Vec2 {
        let share = (point - self.low) / (self.high - self.low);
        Vec2::new(
            self.left + (self.right - self.left) * share.x,
            self.bottom + (self.top - self.bottom) * share.y,
        )
    }

    /// Round numbers along an axis, a few of them.
    fn ticks(&self, axis: usize) -> Vec<f32> {
        let (low, high) = (self.low[axis], self.high[axis]);
        let rough = (high - low) / 6.0;
        let power = ops::powf(10.0, (ops::ln(rough) / core::f32::consts::LN_10).floor());
        let step =
            [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= rough).unwrap_or(power);
        let first = (low / step).ceil() as i64;
        (first..first + 12).map(|k| k as f32 * step).take_while(|x| *x <= high).collect()
    }
}

fn mix(image: &mut RgbImage, x: i64, y: i64, color: [u8; 3], share: f32) {
    let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return };
    if let Some(pixel) = image.get_pixel_mut_checked(x, y) {
        for (old, new) in pixel.0.iter_mut().zip(color) {
            *old = (f32::from(*old) + (f32::from(new) - f32::from(*old)) * share + 0.5) as u8;
        }
    }
}

/// A line between two points of the picture, its edges softened.
fn segment(image: &mut RgbImage, from: Vec2, to: Vec2, color: [u8; 3], width: f32) {
    let reach = 0.5 * width + 1.0;
    let size = Vec2::new(image.width() as f32, image.height() as f32);
    let low = (from.min(to) - reach).max(Vec2::ZERO).floor();
    let high = (from.max(to) + reach).min(size).ceil();
    let way = to - from;
    for y in low.y as i64..high.y as i64 {
        for x in low.x as i64..high.x as i64 {
            let point = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - from;
            let along = (point.dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let off = (point - way * along).length();
            mix(image, x, y, color, (0.5 * width + 0.5 - off).clamp(0.0, 1.0));
        }
    }
}

/// A convex shape in the picture.
fn fill(image: &mut RgbImage, corners: &[Vec2], color: [u8; 3]) {
    if corners.len() < 3 || !corners.iter().all(|c| c.is_finite()) {
        return;
    }
    let size = Vec2::new(image.width() as f32, image.height() as f32);
    let low = corners.iter().fold(size, |l, c| l.min(*c)).max(Vec2::ZERO).floor();
    let high = corners.iter().fold(Vec2::ZERO, |h, c| h.max(*c)).min(size).ceil();
    for y in low.y as i64..high.y as i64 {
        for x in low.x as i64..high.x as i64 {
            let point = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let sides = (0..corners.len()).map(|k| {
                let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
                (b - a).perp_dot(point - a)
            });
            let (mut left, mut right) = (true, true);
            for side in sides {
                left &= side >= -0.5;
                right &= side <= 0.5;
            }
            if left || right {
                mix(image, x, y, color, 1.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inked(image: &RgbImage, color: [u8; 3]) -> usize {
        image.pixels().filter(|p| p.0 == color).count()
    }

    #[test]
    fn a_line_and_a_shape_are_drawn_where_they_are() {
        let mut plot = Plot::of_shapes("a title", "m", "m");
        plot.line("one", [Vec2::ZERO, Vec2::new(2.0, 1.0), Vec2::new(f32::NAN, 0.0), Vec2::ONE]);
        let corners = vec![Vec2::ZERO, Vec2::new(0.0, 1.0), Vec2::new(0.5, 1.0), Vec2::new(0.5, 0.0)];
        plot.shapes.push(Shape { corners, color: [200, 10, 10] });
        let image = plot.draw(300, 200);
        assert!(inked(&image, COLORS[0]) > 60);
        let red = inked(&image, [200, 10, 10]) as f32;
        // 300 x 200 leaves 178 x 138 beside the legend for 2 x 1 units and a margin of six hundredths.
        let unit = 178.0 / 2.12;
        assert!((red / (0.5 * unit * unit) - 1.0).abs() < 0.1, "{red}");
    }

    #[test]
    fn a_plot_of_nothing_has_axes_and_ticks_are_round() {
        assert_eq!(Plot::new("", "", "").draw(0, 0).dimensions(), (80, 60));
        let mut plot = Plot::new("", "", "");
        plot.line("", [Vec2::new(0.0, -90.0), Vec2::new(100.0, 90.0)]);
        let frame = Frame::new(&plot, [0.0, 100.0], [100.0, 0.0]);
        assert_eq!(frame.ticks(0), [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
        assert_eq!(frame.ticks(1), [-50.0, 0.0, 50.0]);
    }
}
