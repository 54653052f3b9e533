//! pdepth.h for Rust: the structs and functions that main.rs uses, as bindgen writes them. std only.
#![allow(non_camel_case_types, dead_code)]
use std::os::raw::{c_char, c_void};

pub const PDEPTH_OK: i32 = 0;
pub const PDEPTH_TOUCHING: i32 = 1;
pub const PDEPTH_OVERLAPPING: i32 = 2;

#[repr(C)]
pub struct pdepth_context {
    _unused: [u8; 0],
}
#[repr(C)]
pub struct pdepth_shape {
    _unused: [u8; 0],
}

#[repr(C)]
pub struct pdepth_error {
    pub status: i32,
    pub reserved: i32,
    pub message: *const c_char,
    pub where_: *const c_char,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pdepth_pose {
    pub form: i32,
    pub reserved: i32,
    pub numbers: [f64; 12],
}

#[repr(C)]
pub struct pdepth_question {
    pub size: u32,
    pub reserved: i32,
    pub a: *const pdepth_shape,
    pub b: *const pdepth_shape,
    pub pose_a: pdepth_pose,
    pub pose_b: pdepth_pose,
    pub settings: *const c_void,
    pub pair: *mut c_void,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pdepth_feature {
    pub kind: i32,
    pub part: i32,
    pub first: i32,
    pub second: i32,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct pdepth_answer {
    pub size: u32,
    pub status: i32,
    pub contact: i32,
    pub method: i32,
    pub warm: i32,
    pub bracket_reached: i32,
    pub depth: f64,
    pub lower: f64,
    pub upper: f64,
    pub distance: f64,
    pub distance_lower: f64,
    pub distance_upper: f64,
    pub translation: [f64; 3],
    pub normal: [f64; 3],
    pub witness_a: [f64; 3],
    pub witness_b: [f64; 3],
    pub feature_a: pdepth_feature,
    pub feature_b: pdepth_feature,
    pub support_calls: i64,
    pub facets_visited: i64,
    pub exact_signs: i64,
}

#[repr(C)]
pub struct pdepth_pose_array {
    pub form: i32,
    pub reserved: i32,
    pub numbers: *const f64,
    pub stride: isize,
}

#[repr(C)]
pub struct pdepth_batch {
    pub size: u32,
    pub threads: i32,
    pub count: i64,
    pub a: *const *const pdepth_shape,
    pub stride_a: isize,
    pub b: *const *const pdepth_shape,
    pub stride_b: isize,
    pub poses_a: pdepth_pose_array,
    pub poses_b: pdepth_pose_array,
    pub settings: *const c_void,
    pub pairs: *const *mut c_void,
    pub stride_pairs: isize,
}

extern "C" {
    pub fn pdepth_status_name(status: i32) -> *const c_char;
    pub fn pdepth_last_error(context: *const pdepth_context, error: *mut pdepth_error) -> i32;
    pub fn pdepth_context_create(allocator: *const c_void, context: *mut *mut pdepth_context) -> i32;
    pub fn pdepth_context_destroy(context: *mut pdepth_context);
    pub fn pdepth_shape_release(shape: *mut pdepth_shape);
    pub fn pdepth_box(context: *mut pdepth_context, half_extents: *const f64, shape: *mut *mut pdepth_shape) -> i32;
    pub fn pdepth_depth(
        context: *mut pdepth_context,
        question: *const pdepth_question,
        answer: *mut pdepth_answer,
    ) -> i32;
    pub fn pdepth_depth_batch(
        context: *mut pdepth_context,
        batch: *const pdepth_batch,
        answers: *mut pdepth_answer,
        stride: isize,
    ) -> i32;
}
