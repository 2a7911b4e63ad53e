#pragma once
#include <array>
#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "supple/math/types.h"

namespace supple {

/// How the rotation R of a corotational element is found.
enum class Rotation {
    large,  ///< frame of the edges at the first corner (x along b-a, z across c-a); cheapest; not the polar factor: a small net torque, no energy
    polar,  ///< polar factor of F, det R = +1, from the last step's by Newton
    svd,    ///< the same rotation, found afresh each time from the singular values of F: forgets every history, however tangled
};

/// Plastic flow of the strain in an element's frame: deviatoric, rate dependent, independent of time step and element size. Where the norm of
/// the elastic deviator e' exceeds the yield strain, e_p += (1 - exp(-creep h)) (|e'| - yield) e'/|e'| at the end of a step of h, then |e_p| <= max.
/// The yield stress in uniaxial tension is 2 mu yield sqrt(3/2). An infinite creep is the radial return of J2 plasticity.
/// Source: O'Brien, Bargteil, Hodgins 2002; Mueller, Gross 2004; with an exact rate.
struct Plasticity {
    double yield = std::numeric_limits<double>::infinity();      ///< scene key plastic_yield: strain, >= 0; infinite: elastic
    double max = std::numeric_limits<double>::infinity();        ///< plastic_max: most plastic strain, >= 0
    double creep_1_s = std::numeric_limits<double>::infinity();  ///< plastic_creep_1_s: rate, >= 0
    bool flows() const { return yield < std::numeric_limits<double>::infinity(); }
};

/// Where a linear or corotational tetrahedron resists a change of volume.
enum class Volumetric {
    element,  ///< in each element: locks as Poisson's ratio nears 1/2, above 0.48 far too stiff
    nodal,    ///< mostly as a mean around each vertex: does not lock, up to 0.4999; two to three times the cost of a solve (fem/nodal_volume.h)
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
    double poisson = 0.3;   ///< Poisson's ratio, in (-1, 0.5); tets of Volumetric::element lock above 0.48
    Plasticity plasticity{};
    Volumetric volumetric = Volumetric::element;          ///< of tetrahedra
    Integration integration = Integration::incompatible;  ///< of hexahedra
};

/// Corotational linear elasticity: the same with e = sym(R^T F) - I, R the rotation of the element. For `polar` and `svd` that is
/// W = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2.
struct Corotational {
    Rotation rotation = Rotation::polar;
    double young_pa = 1e5;  ///< Young's modulus, > 0
    double poisson = 0.3;   ///< Poisson's ratio, in (-1, 0.5); tets of Volumetric::element lock above 0.48
    Plasticity plasticity{};
    Volumetric volumetric = Volumetric::element;          ///< of tetrahedra
    Integration integration = Integration::incompatible;  ///< of hexahedra
};

/// Derivative of a corotational element's force (rotation polar or svd).
enum class Tangent {
    automatic,  ///< in a World exact for the static integrator, warped for the others; in force_differential() warped
    warped,     ///< R K R^T, the rotation held: always positive definite, cheapest; one iteration of it is as good at small strain
    exact,      ///< with the derivative of the rotation, its three twist modes kept from going negative: Newton converges at its own rate
};

// -- hyperelastic laws; energies, sources and inversion: material/laws/<law>.h ---------------------------
// Each ends with `fibres` and `matrix_regularization` (true: the tangent is made positive semidefinite, so that conjugate gradients cannot fail on it;
// false: the exact tangent, which may be indefinite under compression).

/// None, one or two families of fibres: isotropic, transversely isotropic, orthotropic. Each adds k/(2b) (exp(b (I4 - 1)^2) - 1) where it is stretched, I4 = f.C f
/// of the full C (material/laws/fibres.h). Costa's law takes its frame from the same directions: f along `fibre` (default x), s along `sheet` made
/// orthogonal to f (default y, or z where the fibre is y), n = f x s.
struct Fibres {
    std::vector<Vec3> fibre{};        ///< directions at rest, any length above 0: none, one for the body, or one per element in mesh order
    std::vector<Vec3> sheet{};
    double fibre_stiffness_pa = 0;    ///< k >= 0; above 0 it needs directions
    double fibre_exponent = 1;        ///< b > 0
    double sheet_stiffness_pa = 0;
    double sheet_exponent = 1;
};

/// W = lambda/2 (tr E)^2 + mu tr E^2.  Small strain: mu, K = lambda + 2 mu/3.
struct StVenantKirchhoff {
    double mu_pa = 4e4;      ///< > 0
    double lambda_pa = 6e4;  ///< > -2 mu/3
    Fibres fibres{};
    bool matrix_regularization = true;
};

/// W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J.  Small strain: mu, K = lambda + 2 mu/3.
struct NeoHookean {
    double mu_pa = 4e4;      ///< > 0
    double lambda_pa = 6e4;  ///< > -2 mu/3
    Fibres fibres{};
    bool matrix_regularization = true;
};

/// W = mu/2 (I1 - 3) + (lambda + mu)/2 (J - a)^2 - const, a = 1 + mu/(lambda + mu).  Small strain: mu, K = lambda + 2 mu/3. Robust to any deformation.
struct StableNeoHookean {
    double mu_pa = 4e4;      ///< > 0
    double lambda_pa = 6e4;  ///< > -2 mu/3
    Fibres fibres{};
    bool matrix_regularization = true;
};

/// W = c1 (Ib1 - 3) + c2 (Ib2 - 3) + K/2 ln^2 J.  Small strain: mu = 2 (c1 + c2), K.
struct MooneyRivlin {
    double c1_pa = 1.6e4;  ///< c1 + c2 > 0
    double c2_pa = 4e3;
    double bulk_pa = 1e5;  ///< K > 0
    Fibres fibres{};
    bool matrix_regularization = true;
};

/// Eight-chain model to five terms, lambda_m^2 = 8.  Small strain: 1.0851367 mu, K.
struct ArrudaBoyce {
    double mu_pa = 3.7e4;  ///< > 0
    double bulk_pa = 1e5;  ///< K > 0
    Fibres fibres{};
    bool matrix_regularization = true;
};

/// W = c1 (exp(c2 (Ib1 - 3)) - 1) - c1 c2/2 (Ib2 - 3) + K/2 ln^2 J.  Small strain: mu = c1 c2, K.
struct VerondaWestman {
    double c1_pa = 2e4;    ///< > 0
    double c2 = 2;         ///< > 0, dimensionless
    double bulk_pa = 1e5;  ///< K > 0
    Fibres fibres{};
    bool matrix_regularization = true;
};

struct OgdenTerm {
    double mu_pa = 8e4;
    double alpha = 3;      ///< not 0
};

/// W = sum over terms (mu/alpha^2) (sum_i sb_i^alpha - 3) + K/2 ln^2 J.  Small strain: mu = (sum of the terms' mu)/2, K.
struct Ogden {
    std::vector<OgdenTerm> terms{OgdenTerm{}};  ///< at least one, sum of mu > 0
    double bulk_pa = 1e5;  ///< K > 0
    Fibres fibres{};
    bool matrix_regularization = true;
};

/// W = a/2 (exp(Qb) - 1) + K (J ln J - J + 1), Qb = J^-4/3 sum b_ij E_ij^2 in the frame [f s n] of each element.  Small strain: shear moduli a b_ij/2,
/// C_ii = a b_ii + K, C_ij = K (so K acts as Lame's lambda), bulk modulus K + a (b_ff + b_ss + b_nn)/9.
struct Costa {
    double a_pa = 4e4;                            ///< > 0
    double bulk_pa = 6e4;                         ///< K > 0
    std::array<double, 6> b{2, 2, 2, 2, 2, 2};    ///< ff fs ss fn sn nn, each > 0
    Fibres fibres{};
    bool matrix_regularization = true;
};

/// One alternative per law.
using Material =
    std::variant<Corotational, Linear, StVenantKirchhoff, NeoHookean, StableNeoHookean, MooneyRivlin, ArrudaBoyce, VerondaWestman, Ogden, Costa>;

/// True for the laws of a strain energy in F; false for linear elasticity in a frame.
bool is_hyperelastic(const Material& material);

/// Fibres of a hyperelastic law; null for the others.
const Fibres* fibres_of(const Material& material);
/// matrix_regularization of a hyperelastic law; true for the others.
bool is_regularized(const Material& material);
/// Plasticity of a linear or corotational material; that of the others is elastic.
Plasticity plasticity_of(const Material& material);
/// Volumetric of a linear or corotational material; that of the others is `element`.
Volumetric volumetric_of(const Material& material);

struct Lame {
    double lambda_pa = 0;
    double mu_pa = 0;
};

/// Lame parameters at small strain; of Costa's law, Voigt's average over all directions. Fibres are not counted.
/// @error Error(invalid_argument) naming where + the parameter, its legal range and the fix
Lame small_strain(const Material& material, const std::string& where = "material");

/// Checks everything about a material of a body with so many elements: its parameters as small_strain() does, and its fibres.
/// @error Error(invalid_argument) naming where + the parameter, its legal range and the fix
void check_material(const Material& material, std::size_t elements, const std::string& where = "material");

/// lambda = E nu / ((1+nu)(1-2nu)), mu = E / (2(1+nu)).
/// @error Error(invalid_argument) naming where + ".young_pa" / ".poisson" when E is not finite and > 0 or nu not in (-1, 0.5)
Lame lame_parameters(double young_pa, double poisson, const std::string& where);

}  // namespace supple
