//! Plots: lines and filled shapes over two axes, as pictures.

use std::ops::Range;
use std::sync::LazyLock;

use bevy::math::Vec2;
use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};
use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use super::canvas::{INK, PAPER};

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
const GRID: [u8; 3] = [226, 222, 212];
/// Share of a plot's range that is left free at either side.
const FREE: f32 = 0.03;
/// Drawn larger by this, then shrunk: the edges are soft.
const FINER: u32 = 3;
const TEXT: u32 = 14;

/// A line of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Its name in the legend; empty for none.
    pub name: String,
    /// Its points.
    pub points: Vec<Vec2>,
    /// Its colour.
    pub color: [u8; 3],
}

/// A filled shape of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its corners, in order.
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

/// A plot could not be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the plot `{title}` could not be drawn: {reason}")]
pub struct PlotError {
    /// The plot's title.
    pub title: String,
    /// What its library says.
    pub reason: String,
}

type Failed<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

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
        self.lines.push(Line { name: name.into(), points: points.into_iter().collect(), color });
    }

    /// Draws it, pixels wide and high, at least 160 and 120. Points that are not finite are left out; a plot of
    /// nothing has axes from 0 to 1.
    ///
    /// # Errors
    /// [`PlotError`], should the library that draws fail.
    pub fn draw(&self, width: u32, height: u32) -> Result<RgbImage, PlotError> {
        let (width, height) = (width.max(160), height.max(120));
        let mut image = RgbImage::from_pixel(FINER * width, FINER * height, Rgb(PAPER));
        let size = image.dimensions();
        let failed = |reason: String| PlotError { title: self.title.clone(), reason };
        if !*WRITING {
            return Err(failed("its font cannot be read".into()));
        }
        self.draw_on(&BitMapBackend::with_buffer(&mut image, size).into_drawing_area())
            .map_err(|e| failed(e.to_string()))?;
        Ok(imageops::resize(&image, width, height, FilterType::Triangle))
    }

    fn draw_on<B: DrawingBackend>(&self, whole: &DrawingArea<B, Shift>) -> Result<(), Failed<B>> {
        let text = text(TEXT);
        // The legend has a margin of its own, so that no line runs through it.
        let named: Vec<&Line> = self.lines.iter().filter(|line| !line.name.is_empty()).collect();
        let mut widest = 0;
        for line in &named {
            widest = widest.max(whole.estimate_text_size(&line.name, &text)?.0);
        }
        let [width, _] = size(whole);
        let legend = if named.is_empty() { 0 } else { (widest + FINER * 34).min(width / 2) };
        let (left, right) = whole.split_horizontally(width - legend);

        let [margin, below, beside] = [8, 38, 52].map(|pixels| FINER * pixels);
        let title = FINER * 26;
        let [width, height] = size(&left);
        let room = Vec2::new(
            width.saturating_sub(2 * margin + beside) as f32,
            height.saturating_sub(2 * margin + below + title) as f32,
        );
        let [across, up] = self.ranges(room.max(Vec2::ONE));
        let mut chart = ChartBuilder::on(&left)
            .margin(margin)
            .x_label_area_size(below)
            .y_label_area_size(beside)
            .margin_top(margin + title)
            .build_cartesian_2d(across, up)?;
        let paint = |color: [u8; 3]| RGBColor(color[0], color[1], color[2]);
        chart
            .configure_mesh()
            .bold_line_style(paint(GRID))
            .light_line_style(TRANSPARENT)
            .axis_style(paint(INK))
            .label_style(text.clone())
            .x_labels(8)
            .y_labels(8)
            .x_desc(&self.x)
            .y_desc(&self.y)
            .x_label_formatter(&|x| number(*x))
            .y_label_formatter(&|y| number(*y))
            .draw()?;
        left.draw_text(&self.title, &text, ((margin + beside) as i32, margin as i32))?;
        let plain = |points: &[Vec2]| points.iter().map(|p| (p.x, p.y)).collect::<Vec<_>>();
        for shape in self.shapes.iter().filter(|s| s.corners.iter().all(|c| c.is_finite())) {
            chart.draw_series([Polygon::new(plain(&shape.corners), paint(shape.color).filled())])?;
        }
        for line in &self.lines {
            let style = paint(line.color).stroke_width(FINER + 1);
            let whole = line.points.split(|p| !p.is_finite()).filter(|points| points.len() > 1);
            chart.draw_series(whole.map(|points| PathElement::new(plain(points), style)))?;
        }
        for (k, line) in named.iter().enumerate() {
            let y = (FINER * (40 + 16 * k as u32)) as i32;
            let end = (FINER * 18) as i32;
            let stroke = paint(line.color).stroke_width(2 * FINER);
            right.draw(&PathElement::new(vec![(0, y), (end, y)], stroke))?;
            right.draw_text(&line.name, &text, (end + 10, y - (FINER * TEXT / 2) as i32))?;
        }
        whole.present()
    }

    /// What is seen along each axis, in a room of so many pixels.
    fn ranges(&self, room: Vec2) -> [Range<f32>; 2] {
        let lines = self.lines.iter().flat_map(|line| &line.points);
        let points = lines.chain(self.shapes.iter().flat_map(|shape| &shape.corners));
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for point in points.filter(|p| p.is_finite()) {
            (low, high) = (low.min(*point), high.max(*point));
        }
        if !(low.is_finite() && high.is_finite()) {
            (low, high) = (Vec2::ZERO, Vec2::ONE);
        }
        let mut size = (high - low).max(Vec2::splat(1e-6));
        if self.equal {
            size = room * (size / room).max_element();
        }
        let (middle, half) = (0.5 * (low + high), (0.5 + FREE) * size);
        [middle.x - half.x..middle.x + half.x, middle.y - half.y..middle.y + half.y]
    }
}

/// Whether the font of plots could be read.
static WRITING: LazyLock<bool> = LazyLock::new(|| {
    register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT).is_ok()
});

fn text(height: u32) -> TextStyle<'static> {
    ("sans-serif", FINER * height).into_font().color(&RGBColor(INK[0], INK[1], INK[2]))
}

fn size<B: DrawingBackend>(area: &DrawingArea<B, Shift>) -> [u32; 2] {
    let (width, height) = area.dim_in_pixel();
    [width, height]
}

/// A number with as many digits as it needs.
fn number(x: f32) -> String {
    let text = format!("{x:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inked(image: &RgbImage, color: [u8; 3]) -> usize {
        image.pixels().filter(|p| p.0.iter().zip(color).all(|(a, b)| a.abs_diff(b) < 12)).count()
    }

    #[test]
    fn a_line_and_a_shape_are_drawn_where_they_are() {
        let mut plot = Plot::of_shapes("a title", "m", "m");
        plot.line("one", [Vec2::ZERO, Vec2::new(2.0, 1.0), Vec2::new(f32::NAN, 0.0), Vec2::ONE]);
        let corners = vec![Vec2::ZERO, Vec2::new(0.0, 1.0), Vec2::new(0.5, 1.0), Vec2::new(0.5, 0.0)];
        plot.shapes.push(Shape { corners, color: [200, 10, 10] });
        let image = plot.draw(600, 400).unwrap();
        assert!(inked(&image, COLORS[0]) > 200);
        let red: Vec<(u32, u32)> = (0..600)
            .flat_map(|x| (0..400).map(move |y| (x, y)))
            .filter(|&(x, y)| image.get_pixel(x, y).0 == [200, 10, 10])
            .collect();
        let extent = |along: Vec<u32>| (along.iter().max().unwrap() - along.iter().min().unwrap() + 1) as f32;
        let wide = extent(red.iter().map(|p| p.0).collect());
        let high = extent(red.iter().map(|p| p.1).collect());
        // Half a unit wide and one high, and the units are alike; the line covers its corner.
        assert!((high / wide - 2.0).abs() < 0.05, "{wide} x {high}");
        // All else but the line's own crossing of it is red.
        assert!(red.len() as f32 > 0.9 * wide * high);
    }

    #[test]
    fn a_plot_of_nothing_has_axes() {
        let plot = Plot::new("", "", "");
        let image = plot.draw(0, 0).unwrap();
        assert_eq!(image.dimensions(), (160, 120));
        let dark = image.pixels().filter(|p| p.0.iter().all(|c| *c < 170)).count();
        assert!((100..2000).contains(&dark), "axes and numbers: {dark} pixels");
        for range in plot.ranges(Vec2::ONE) {
            assert!((range.start + FREE).abs() < 1e-6 && (range.end - 1.0 - FREE).abs() < 1e-6, "{range:?}");
        }
    }

    #[test]
    fn numbers_have_as_many_digits_as_they_need() {
        assert_eq!([0.0, -0.0, 0.25, -40.0, 1.0004].map(number), ["0", "0", "0.25", "-40", "1"]);
    }
}
