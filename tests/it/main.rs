//! The tests from outside, one program: linking is most of what a test costs to build.

mod architecture;
mod command;
mod compare;
mod dendrites;
mod digests;
mod examples;
mod exr;
mod geometry;
mod growth;
mod house;
mod irregular;
mod limits;
mod mutated;
mod new;
mod outputs;
mod povray;
mod preview;
mod readme;
mod rib;
mod scenes;
mod scipy;
mod signals;
mod strangers;
mod strike;
mod support;
mod voxels;
