//! One palette for all frames: variance cut over a histogram of their colours.

use std::collections::BTreeMap;

use image::RgbImage;

/// What the eye minds of a difference in red, green and blue.
const WEIGHT: [i32; 3] = [3, 5, 2];

/// Finds the few colours that stand for many.
pub(super) struct Quantizer {
    palette: Vec<[u8; 3]>,
    /// Nearest palette entry by colour cell, once asked for.
    nearest: Vec<Option<u8>>,
}

/// Colours are counted in cells of 4 levels a channel.
fn cell(color: [u8; 3]) -> usize {
    color.iter().fold(0, |at, c| at << 6 | usize::from(c >> 2))
}

fn distance(a: [u8; 3], b: [u8; 3]) -> i32 {
    (0..3).map(|i| (i32::from(a[i]) - i32::from(b[i])).pow(2) * WEIGHT[i]).sum()
}

/// Colours with their counts.
struct Cluster {
    colors: Vec<([u8; 3], u64)>,
    mean: [f64; 3],
    /// Channel it is widest in and its weighted scatter there.
    widest: usize,
    scatter: f64,
}

impl Cluster {
    fn new(colors: Vec<([u8; 3], u64)>) -> Self {
        let count = colors.iter().map(|c| c.1).sum::<u64>().max(1) as f64;
        let mean =
            [0, 1, 2].map(|i| colors.iter().map(|c| f64::from(c.0[i]) * c.1 as f64).sum::<f64>() / count);
        let scatter = [0, 1, 2].map(|i| {
            let spread = colors.iter().map(|c| (f64::from(c.0[i]) - mean[i]).powi(2) * c.1 as f64);
            spread.sum::<f64>() * f64::from(WEIGHT[i])
        });
        let widest = (0..3).fold(0, |best, i| if scatter[i] > scatter[best] { i } else { best });
        Self { mean, widest, scatter: if colors.len() > 1 { scatter[widest] } else { 0.0 }, colors }
    }

    fn split(self) -> [Self; 2] {
        let (low, high) =
            self.colors.into_iter().partition(|c| f64::from(c.0[self.widest]) <= self.mean[self.widest]);
        [Self::new(low), Self::new(high)]
    }
}

impl Quantizer {
    /// A palette of at most `most` colours for all frames.
    pub(super) fn of(frames: &[RgbImage], most: usize) -> Self {
        let mut cells: BTreeMap<usize, ([u64; 3], u64)> = BTreeMap::new();
        for pixel in frames.iter().flat_map(|f| f.pixels()) {
            let (sum, count) = cells.entry(cell(pixel.0)).or_default();
            (0..3).for_each(|i| sum[i] += u64::from(pixel.0[i]));
            *count += 1;
        }
        // Roots of counts: a lamp's few bright pixels matter beside a whole sky.
        let colors = cells
            .into_values()
            .map(|(sum, count)| (sum.map(|s| (s / count) as u8), ((count as f64).sqrt() * 16.0) as u64 + 1));
        let mut clusters = vec![Cluster::new(colors.collect())];
        while clusters.len() < most {
            let worst = (0..clusters.len())
                .fold(0, |best, i| if clusters[i].scatter > clusters[best].scatter { i } else { best });
            if clusters[worst].scatter <= 0.0 {
                break;
            }
            let halves = clusters.swap_remove(worst).split();
            clusters.extend(halves);
        }
        let mut palette: Vec<[u8; 3]> = clusters.iter().map(|c| c.mean.map(|m| m.round() as u8)).collect();
        palette.sort_unstable();
        Self { palette, nearest: vec![None; 1 << 18] }
    }

    pub(super) fn palette(&self) -> &[[u8; 3]] {
        &self.palette
    }

    /// Index of the palette's colour nearest to a colour; the lowest of equals.
    pub(super) fn nearest(&mut self, color: [u8; 3]) -> u8 {
        let at = cell(color);
        if let Some(known) = self.nearest[at] {
            return known;
        }
        let middle = color.map(|c| c & !3 | 2);
        let best =
            (0..self.palette.len()).min_by_key(|i| distance(self.palette[*i], middle)).unwrap_or(0) as u8;
        self.nearest[at] = Some(best);
        best
    }

    /// Whether a palette colour is within a tolerance of a colour.
    pub(super) fn is_near(&self, index: u8, color: [u8; 3], tolerance: u8) -> bool {
        let reach = i32::from(tolerance).pow(2) * WEIGHT.iter().sum::<i32>() / 3;
        distance(self.palette[usize::from(index)], color) < reach
    }
}
