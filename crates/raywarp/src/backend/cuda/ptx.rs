//! The kernels as PTX, made by `cargo xtask ptx`.

use crate::backend::PtxInfo;

pub(super) fn source(_name: &str) -> Option<&'static str> {
    Some(include_str!("raywarp.ptx"))
}

pub(in crate::backend) fn info() -> PtxInfo {
    PtxInfo { target: "sm_75".into(), isa: "?".into(), producer: "?".into() }
}
