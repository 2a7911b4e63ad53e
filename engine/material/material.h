#pragma once
#include <string>
#include <variant>

namespace supple {

/// How the rotation of a corotational element is found.
enum class Rotation { polar };

/// Corotational linear elasticity:  W = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2,  R the rotation of F.
/// Small strain: shear modulus mu, bulk modulus lambda + 2 mu/3.
struct Corotational {
    Rotation rotation = Rotation::polar;
    double young_pa = 1e5;  ///< Young's modulus, > 0
    double poisson = 0.3;   ///< Poisson's ratio, in (-1, 0.5); plain tets lock above 0.48
};

/// One alternative per law.
using Material = std::variant<Corotational>;

struct Lame {
    double lambda_pa = 0;
    double mu_pa = 0;
};

/// lambda = E nu / ((1+nu)(1-2nu)), mu = E / (2(1+nu)).
/// @error Error(invalid_argument) naming where + ".young_pa" / ".poisson" when E is not finite and > 0 or nu not in (-1, 0.5)
Lame lame_parameters(double young_pa, double poisson, const std::string& where);

}  // namespace supple
