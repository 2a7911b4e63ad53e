#pragma once
#include <string>
#include <variant>
#include <vector>

namespace supple {

/// How the rotation R of a corotational element is found.
enum class Rotation {
    large,  ///< frame of the edges at the first corner (x along b-a, z across c-a); cheapest; not the polar factor: a small net torque, no energy
    polar,  ///< polar factor of F, det R = +1, from the last step's by Newton
    svd,    ///< the same rotation, found afresh each time from the singular values of F: forgets every history, however tangled
};

/// How the stiffness of a hexahedron is made; tetrahedra have one way only. Both cost the same at run time.
enum class Integration {
    incompatible,  ///< bending and nearly incompressible matter without locking: twelve inner modes, condensed (fem/hex8_stiffness.h)
    full,          ///< the trilinear displacements alone: far too stiff in bending and above nu = 0.45; for comparison with other programs
};

/// Small displacements:  W = mu e:e + lambda/2 tr(e)^2,  e = sym(F) - I. Rotations beyond a few degrees swell the body.
/// Small strain: shear modulus mu, bulk modulus lambda + 2 mu/3.
struct Linear {
    double young_pa = 1e5;  ///< Young's modulus, > 0
    double poisson = 0.3;   ///< Poisson's ratio, in (-1, 0.5); plain tets lock above 0.48
    Integration integration = Integration::incompatible;  ///< of hexahedra
};

/// Corotational linear elasticity: the same with e = sym(R^T F) - I, R the rotation of the element. For `polar` and `svd` that is
/// W = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2.
struct Corotational {
    Rotation rotation = Rotation::polar;
    double young_pa = 1e5;  ///< Young's modulus, > 0
    double poisson = 0.3;   ///< Poisson's ratio, in (-1, 0.5); plain tets lock above 0.48
    Integration integration = Integration::incompatible;  ///< of hexahedra
};

// -- hyperelastic laws; energies, sources and inversion: material/laws/<law>.h ---------------------------

/// W = lambda/2 (tr E)^2 + mu tr E^2.  Small strain: mu, K = lambda + 2 mu/3.
struct StVenantKirchhoff {
    double mu_pa = 4e4;      ///< > 0
    double lambda_pa = 6e4;  ///< > -2 mu/3
};

/// W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J.  Small strain: mu, K = lambda + 2 mu/3.
struct NeoHookean {
    double mu_pa = 4e4;      ///< > 0
    double lambda_pa = 6e4;  ///< > -2 mu/3
};

/// W = mu/2 (I1 - 3) + (lambda + mu)/2 (J - a)^2 - const, a = 1 + mu/(lambda + mu).  Small strain: mu, K = lambda + 2 mu/3. Robust to any deformation.
struct StableNeoHookean {
    double mu_pa = 4e4;      ///< > 0
    double lambda_pa = 6e4;  ///< > -2 mu/3
};

/// W = c1 (Ib1 - 3) + c2 (Ib2 - 3) + K/2 ln^2 J.  Small strain: mu = 2 (c1 + c2), K.
struct MooneyRivlin {
    double c1_pa = 1.6e4;  ///< c1 + c2 > 0
    double c2_pa = 4e3;
    double bulk_pa = 1e5;  ///< K > 0
};

/// Eight-chain model to five terms, lambda_m^2 = 8.  Small strain: 1.0851367 mu, K.
struct ArrudaBoyce {
    double mu_pa = 3.7e4;  ///< > 0
    double bulk_pa = 1e5;  ///< K > 0
};

/// W = c1 (exp(c2 (Ib1 - 3)) - 1) - c1 c2/2 (Ib2 - 3) + K/2 ln^2 J.  Small strain: mu = c1 c2, K.
struct VerondaWestman {
    double c1_pa = 2e4;    ///< > 0
    double c2 = 2;         ///< > 0, dimensionless
    double bulk_pa = 1e5;  ///< K > 0
};

struct OgdenTerm {
    double mu_pa = 8e4;
    double alpha = 3;      ///< not 0
};

/// W = sum over terms (mu/alpha^2) (sum_i sb_i^alpha - 3) + K/2 ln^2 J.  Small strain: mu = (sum of the terms' mu)/2, K.
struct Ogden {
    std::vector<OgdenTerm> terms{OgdenTerm{}};  ///< at least one, sum of mu > 0
    double bulk_pa = 1e5;  ///< K > 0
};

/// One alternative per law.
using Material = std::variant<Corotational, Linear, StVenantKirchhoff, NeoHookean, StableNeoHookean, MooneyRivlin, ArrudaBoyce, VerondaWestman, Ogden>;

/// True for the laws of a strain energy in F; false for linear elasticity in a frame.
bool is_hyperelastic(const Material& material);

struct Lame {
    double lambda_pa = 0;
    double mu_pa = 0;
};

/// Lame parameters at small strain.
/// @error Error(invalid_argument) naming where + the parameter, its legal range and the fix
Lame small_strain(const Material& material, const std::string& where = "material");

/// lambda = E nu / ((1+nu)(1-2nu)), mu = E / (2(1+nu)).
/// @error Error(invalid_argument) naming where + ".young_pa" / ".poisson" when E is not finite and > 0 or nu not in (-1, 0.5)
Lame lame_parameters(double young_pa, double poisson, const std::string& where);

}  // namespace supple
