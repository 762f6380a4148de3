//! stub
use super::StandingSolid;
use bevy::prelude::*;
/// x
pub struct Advance { /// d
 pub direction: Vec3, /// l
 pub length: f32 }
/// stub
pub fn advance(_s: &[StandingSolid], ground: Option<f32>, from: Vec3, direction: Vec3, length: f32, _radius: f32) -> Advance {
  if let Some(g)=ground { if (from+direction*length).y < g { return Advance{direction, length:0.0} } }
  Advance{direction,length}
}
/// stub
pub fn touches(_s:&StandingSolid,_f:Vec3,_t:Vec3,_r:f32)->bool{false}
