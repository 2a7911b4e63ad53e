#include "material_option.h"

#include "supple/base/error.h"
#include "supple/io/scene.h"

namespace supple::demos {

/// Read as part of a scene with a box, so that keys, defaults and messages are those of scene files.
Material parse_material(const std::string& text) {
    const std::string scene =
        R"({"supple_scene": 1, "bodies": [{"box": {"min_m": [0, 0, 0], "max_m": [1, 1, 1], "cells": [1, 1, 1]}, "material": )" + text + "}]}";
    const BodyDef body = io::parse_scene(scene, ".", "--material").bodies.at(0).def;
    if (!body.young_pa_per_element.empty() || !body.poisson_per_element.empty() || !body.material_per_element.empty())
        throw Error(ErrorCode::unsupported, "--material", "takes one number of each parameter for all elements");
    return body.material;
}

}  // namespace supple::demos
