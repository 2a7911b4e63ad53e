#pragma once
#include <optional>

namespace supple::contact {

/// First moment in [0, 1] at which a + b t + c t^2 + d t^3 falls from zero or above to below zero; none: it does not. What moves evenly passes a plane through three
/// points that do so too, or an edge another, where such a cubic vanishes (Provot 1997).
std::optional<double> first_fall(double a, double b, double c, double d);

}  // namespace supple::contact
