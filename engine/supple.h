#pragma once
/// Everything of supple::core in one include. File formats: <supple/io/...>; rendering: <supple/render/...>.
#include "supple/base/error.h"
#include "supple/material/material.h"
#include "supple/mesh/box_mesh.h"
#include "supple/mesh/selection.h"
#include "supple/mesh/surface.h"
#include "supple/mesh/volume_mesh.h"
#include "supple/world/body_template.h"
#include "supple/world/evaluate.h"
#include "supple/world/world.h"
