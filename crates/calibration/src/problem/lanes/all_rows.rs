//! All rows in lanes: handed over block by block, or folded in parallel to one triangle for each channel.

use std::cell::RefCell;

use haptical_identification::Triangle;
use haptical_linalg::LinalgError;
use rayon::prelude::*;

use crate::DeviceProblem;
use crate::problem::lanes::pass::{PartRows, Pass, Room};
use crate::problem::lanes::plan::{LaneRows, RowBlock};

/// Blocks from which several threads are worth it.
const BLOCKS_FOR_THREADS: usize = 2;

/// Rows in lanes, with room that is kept from pass to pass.
#[derive(Debug)]
pub(crate) struct Lanes {
    rows: LaneRows,
    rooms: RefCell<Vec<Room>>,
}

impl Lanes {
    /// None where the problem has no form in lanes.
    pub(crate) fn new(problem: &DeviceProblem<'_>) -> Option<Self> {
        Some(Self {
            rows: LaneRows::new(problem)?,
            rooms: RefCell::default(),
        })
    }

    /// Hands every channel's rows to `visit`, block by block; none where a number is refused.
    pub(crate) fn visit(
        &self,
        problem: &DeviceProblem<'_>,
        parameters: &[f64],
        free: &[usize],
        mut visit: impl FnMut(&PartRows<'_>),
    ) -> Option<()> {
        let pass = Pass::new(&self.rows, problem, parameters, free)?;
        if self.rows.blocks.is_empty() {
            let mut room = Room::default();
            return self.rows.starts.iter().try_for_each(|&start| {
                let block = self.rows.block(problem, start)?;
                room.forget();
                pass.block(&block, &mut room, |rows| {
                    visit(rows);
                    Some(())
                })
            });
        }
        // taken out: `visit` may ask for another pass
        let mut rooms = self.rooms.take();
        rooms.resize_with(self.rows.blocks.len(), Room::default);
        let mut pairs = self.rows.blocks.iter().zip(&mut rooms);
        let visited = pairs.try_for_each(|(block, room)| {
            pass.block(block, room, |rows| {
                visit(rows);
                Some(())
            })
        });
        self.rooms.replace(rooms);
        visited
    }

    /// One triangle for each channel; the blocks are folded in parallel and merged in order, so that the bits do
    /// not depend on the number of threads. None where a number is refused.
    pub(crate) fn reduce(
        &self,
        problem: &DeviceProblem<'_>,
        parameters: &[f64],
        free: &[usize],
    ) -> Option<Vec<ChannelTriangle>> {
        let pass = Pass::new(&self.rows, problem, parameters, free)?;
        let fold = |(block, room): (&RowBlock, &mut Room)| {
            let mut triangles: Vec<Triangle> = pass
                .channels
                .iter()
                .map(|columns| Triangle::new(columns.distinct))
                .collect();
            let folded = pass.block(block, room, |rows| {
                let triangle = &mut triangles[rows.channel];
                triangle.fold_rows(rows.derivatives, rows.residuals).ok()
            });
            folded.map(|()| triangles)
        };
        let mut rooms = self.rooms.take();
        rooms.resize_with(self.rows.blocks.len(), Room::default);
        let several =
            self.rows.blocks.len() >= BLOCKS_FOR_THREADS && rayon::current_num_threads() > 1;
        let folded: Option<Vec<Vec<Triangle>>> = if self.rows.blocks.is_empty() {
            let rows = &self.rows;
            let made = rows
                .starts
                .par_iter()
                .map_init(Room::default, |room, &start| {
                    let block = rows.block(problem, start)?;
                    room.forget();
                    fold((&block, room))
                });
            made.collect()
        } else if several {
            let pairs = self.rows.blocks.par_iter().zip(rooms.par_iter_mut());
            pairs.map(fold).collect()
        } else {
            self.rows.blocks.iter().zip(&mut rooms).map(fold).collect()
        };
        self.rooms.replace(rooms);
        let folded = folded.filter(|blocks| !blocks.is_empty())?;
        let channels = pass.channels.into_iter().zip(merge_parts(folded).ok()?);
        let channels = channels.map(|(columns, triangle)| ChannelTriangle {
            columns: columns.positions,
            of: columns.of,
            triangle,
        });
        Some(channels.collect())
    }
}

/// The triangles of successive rows, channel by channel, merged in their order.
pub(crate) fn merge_parts(parts: Vec<Vec<Triangle>>) -> Result<Vec<Triangle>, LinalgError> {
    let mut parts = parts.into_iter();
    let mut totals = parts.next().unwrap_or_default();
    for part in parts {
        for (total, triangle) in totals.iter_mut().zip(&part) {
            total.merge(triangle)?;
        }
    }
    Ok(totals)
}

/// `[F q]` of one channel, of the columns that differ.
#[derive(Debug, Clone)]
pub(crate) struct ChannelTriangle {
    /// Position within the free parameters of each column.
    pub(crate) columns: Vec<usize>,
    /// Which of the triangle's columns each is.
    pub(crate) of: Vec<usize>,
    pub(crate) triangle: Triangle,
}
