//! The model `physical`: its settings.

use serde::{Deserialize, Serialize};

/// Settings of the model `physical`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Physical {}
