//! A depth, a batch and an error through libpdepth from Rust.
mod sys;
use std::{ffi::CStr, mem::size_of, os::raw::c_char, ptr::null_mut};
use sys::*;

/// A struct of zeros, which is the default of every struct of pdepth.h.
fn zeros<T>() -> T {
    unsafe { std::mem::zeroed() }
}

fn text(chars: *const c_char) -> String {
    unsafe { CStr::from_ptr(chars) }.to_string_lossy().into_owned()
}

fn error_of(context: *const pdepth_context, status: i32) -> String {
    let mut error: pdepth_error = zeros();
    unsafe { pdepth_last_error(context, &mut error) };
    format!("{}: {} ({})", text(unsafe { pdepth_status_name(status) }), text(error.message), text(error.where_))
}

fn main() {
    let (mut context, mut cube, mut none) = (null_mut(), null_mut(), null_mut());
    assert_eq!(unsafe { pdepth_context_create(null_mut(), &mut context) }, PDEPTH_OK);
    let require = |status| assert_eq!(status, PDEPTH_OK, "{}", error_of(context, status));
    require(unsafe { pdepth_box(context, [0.5, 0.5, 0.5].as_ptr(), &mut cube) });

    // One pair: the cubes overlap by a quarter.
    let mut question = pdepth_question { size: size_of::<pdepth_question>() as u32, a: cube, b: cube, ..zeros() };
    question.pose_b.numbers[0] = 0.75;
    let mut answer = pdepth_answer { size: size_of::<pdepth_answer>() as u32, ..zeros() };
    require(unsafe { pdepth_depth(context, &question, &mut answer) });
    let [x, y, z] = answer.translation;
    println!("depth {}, A moves by {} {} {}", answer.depth, x, y, z);

    // A thousand places of B on two threads.
    let positions: Vec<[f64; 3]> = (0..1000).map(|i| [f64::from(i) / 128.0, 0.0, 0.0]).collect();
    let mut answers = vec![answer; positions.len()];
    let shape = cube as *const pdepth_shape;
    let mut batch = pdepth_batch { size: size_of::<pdepth_batch>() as u32, threads: 2, count: 1000, ..zeros() };
    (batch.a, batch.b) = (&shape, &shape);
    (batch.poses_b.numbers, batch.poses_b.stride) = (positions.as_ptr().cast(), size_of::<[f64; 3]>() as isize);
    let stride = size_of::<pdepth_answer>() as isize;
    require(unsafe { pdepth_depth_batch(context, &batch, answers.as_mut_ptr(), stride) });
    let count = |contact| answers.iter().filter(|answer| answer.contact == contact).count();
    println!("1000 places: {} overlap, {} touch", count(PDEPTH_OVERLAPPING), count(PDEPTH_TOUCHING));

    // Bad input is a named error.
    let status = unsafe { pdepth_box(context, [0.5, -0.5, 0.5].as_ptr(), &mut none) };
    println!("{}", error_of(context, status));

    unsafe { pdepth_shape_release(cube) };
    unsafe { pdepth_context_destroy(context) };
}
