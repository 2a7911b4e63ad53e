#pragma once
#include "supple/io/json_node.h"
#include "supple/material/material.h"

namespace supple::io {

inline constexpr double kMostPascal = 1e15;

/// The name of a law in a scene file.
const char* law_name(const Material& material);

/// A law by its name, with its default parameters.
/// @param name  StVenantKirchhoff, NeoHookean, StableNeoHookean, MooneyRivlin, ArrudaBoyce, VerondaWestman, Ogden or Costa
Material default_hyperelastic(const std::string& name);

/// True if a number of a hyperelastic material is given as a list, one per element.
bool has_lists(const JsonNode& node);

/// A hyperelastic material: its keys, checked. mu_pa and lambda_pa may also be given as young_pa and poisson.
/// @param base      the law, and the value of every parameter that is not named
/// @param from_base true if base is a material of the user's: then young_pa or poisson may be given alone
/// @param elements  of the body
/// @param element   whose numbers to take from lists
Material read_hyperelastic(const JsonNode& node, const Material& base, bool from_base, std::size_t elements, std::size_t element = 0);

}  // namespace supple::io
