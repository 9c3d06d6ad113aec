//! Options of what lies beyond a scene.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use raywarp::scene::{load, radians, Environment, LoadOptions, Loaded};
use raywarp::write::Outputs;

use crate::failure::{ensure, Result};
use crate::values;

/// Light from all around, for path tracing.
#[derive(Clone, Debug, Default, Args)]
pub struct EnvironmentOptions {
    /// Picture all around in longitude and latitude that lights the scene with --integrator path: .hdr or .exr
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Picture")]
    pub hdri: Option<PathBuf>,
    /// Turn it by so many degrees, counter-clockwise as seen from above [default: the scene file's, else 0]
    #[arg(long, value_name = "DEGREES", value_parser = values::turn, allow_hyphen_values = true)]
    #[arg(help_heading = "Picture")]
    pub hdri_rotation: Option<f32>,
    /// Multiply its radiance [default: the scene file's, else 1]
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, help_heading = "Picture")]
    pub hdri_strength: Option<f32>,
}

impl EnvironmentOptions {
    /// Gives a scene what was asked for instead of its own.
    pub fn change(&self, loaded: &mut Loaded, outputs: &mut Outputs) -> Result<()> {
        outputs.reads(&self.hdri)?;
        let own = loaded.scene.environment.take();
        loaded.scene.environment = self.instead_of(own)?;
        loaded.files.extend(self.hdri.clone());
        Ok(())
    }

    /// What was asked for, or what there is, turned and scaled as asked.
    pub fn instead_of(&self, own: Option<Environment>) -> Result<Option<Environment>> {
        let asked = self.hdri.as_ref().map(|path| load::environment(path, &LoadOptions::default())).transpose()?;
        let mut environment = asked.or(own);
        let turned = self.hdri_rotation.is_some() || self.hdri_strength.is_some();
        ensure!(!turned || environment.is_some(), "there is no environment to turn or to scale: give --hdri FILE");
        if let Some(environment) = &mut environment {
            environment.rotation = self.hdri_rotation.map_or(environment.rotation, |angle| radians(angle.into()));
            environment.strength = self.hdri_strength.unwrap_or(environment.strength);
        }
        Ok(environment)
    }

    /// The options again, as words.
    pub fn flags(&self) -> String {
        let file = self.hdri.as_deref().and_then(|path| path.file_name());
        let file = file.map(|name| format!(" --hdri {}", name.to_string_lossy())).unwrap_or_default();
        let turn = self.hdri_rotation.map(|angle| format!(" --hdri-rotation={angle:?}")).unwrap_or_default();
        let scale = self.hdri_strength.map(|factor| format!(" --hdri-strength={factor:?}")).unwrap_or_default();
        format!("{file}{turn}{scale}")
    }
}
