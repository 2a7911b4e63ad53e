// Rows 5, 14 and 18: the patch test, Cook's membrane, the plate with a hole.
#include <cmath>

#include "quadrature.h"
#include "random.h"
#include "statics.h"
#include "supple/world/evaluate.h"
#include "table.h"

namespace supple::verify {
namespace {

constexpr double kYoung = 1e5;

// -- row 5 ------------------------------------------------------------------------------------------------

struct PatchErrors {
    double position = 0, stress = 0;
};

/// Boundary vertices at A X + t, the inner ones found: they must follow, with the stress of a homogeneous strain everywhere.
PatchErrors patch(Kind kind, const Material& material, const Mat3& A, const Settings& settings) {
    Statics cube(irregular_cube(kind, 4, 0.25, 5), material, {.tolerance = 1e-14, .threads = settings.threads});  // down to rounding
    Mat34 map;
    map << A, Vec3(0.1, -0.2, 0.3);
    cube.move([](const Vec3& X) { return X.minCoeff() < 1e-9 || X.maxCoeff() > 1 - 1e-9; }, {map});
    cube.solve();
    PatchErrors errors;
    for (std::size_t i = 0; i < cube.x().size(); ++i)
        errors.position = std::max(errors.position, (cube.x()[i] - (A * cube.mesh().vertices[i] + map.col(3))).norm());
    const Voigt exact = [&] {
        std::vector<Vec3> x;
        for (const Vec3& X : cube.mesh().vertices) x.push_back(A * X);
        return evaluate(cube.world().shape(cube.body()), material, x).element_stress_pa[0];
    }();
    double size = 0;
    for (const double s : exact) size = std::max(size, std::abs(s));
    for (const Voigt& s : cube.world().element_cauchy_stress(cube.body()))
        for (std::size_t c = 0; c < 6; ++c) errors.stress = std::max(errors.stress, std::abs(s[c] - exact[c]) / size);
    return errors;
}

void patch_test(Table& table, const Settings& settings) {
    Random random(6);
    const Mat3 small = Mat3::Identity() + random.matrix(0.1);  // of a law of small strain, whose answer is linear however large
    Mat3 large = random.rotation() * (Mat3::Identity() + random.matrix(0.15));
    for (const Kind kind : element_kinds()) {
        const PatchErrors linear = patch(kind, Linear{.young_pa = kYoung, .poisson = 0.3}, small, settings);
        table.below("patch test, distorted " + name(kind) + ", small strain: positions [m]", linear.position, 1e-12);
        table.below("patch test, distorted " + name(kind) + ", small strain: stress, relative", linear.stress, 1e-12);
        const PatchErrors corotational = patch(kind, Corotational{.young_pa = kYoung, .poisson = 0.3}, large, settings);
        table.below("patch test, distorted " + name(kind) + ", corotational, large affine map: positions [m]", corotational.position, 1e-10);
        table.below("patch test, distorted " + name(kind) + ", corotational, large affine map: stress, relative", corotational.stress, 1e-10);
    }
}

// -- row 14 -----------------------------------------------------------------------------------------------

/// Corners (0,0) (48,44) (48,60) (0,44), thickness 1, one layer of n x n cells. Counted from the right, so that cells are cut into tets along their shorter diagonal.
VolumeMesh membrane(Kind kind, int n) {
    return mapped_box(kind, {n, n, 1}, [](const Vec3& s) {
        const double across = 1 - s.x(), x = 48 * across, low = 44 * across, high = 44 + 16 * across;
        return Vec3(x, low + s.y() * (high - low), s.z());
    });
}

/// Vertical displacement of (48, 52) under unit shear force on x = 48. z is held on one face (the middle of a plate twice as thick, free outside: plane stress)
/// or on both (plane strain).
double cook(Kind kind, int n, const Material& material, bool plane_strain, const Settings& settings) {
    const bool nodal = kind == Kind::tets && volumetric_of(material) == Volumetric::nodal;  // that stiffness lies beside the matrix: a factor does not hold it
    Statics plate(membrane(kind, n), material,
                  {.tolerance = nodal ? 1e-6 : 1e-9, .threads = settings.threads, .preconditioner = nodal ? PreconditionerKind::automatic : PreconditionerKind::direct});
    plate.hold(on_plane(0, 0), {.x = true, .y = true, .z = false});
    plate.hold(plane_strain ? everywhere() : on_plane(2, 0), {.x = false, .y = false, .z = true});
    const double force = 1;  // the material is linear: any will do
    plate.load(traction_forces(plate.mesh(), on_plane(0, 48), [&](const Vec3&, const Vec3&) { return Vec3(0, force / 16, 0); }));
    plate.solve();
    const Where middle = [](const Vec3& X) { return std::abs(X.x() - 48) < 1e-6 && std::abs(X.y() - 52) < 1e-6; };
    return plate.displacement(middle).y() / force;
}

void cooks_membrane(Table& table, const Settings& settings) {
    for (const Kind kind : element_kinds()) {
        const Material m = Linear{.young_pa = 1, .poisson = 1.0 / 3};
        const int n = 16;
        const double coarse = cook(kind, n / 2, m, false, settings), fine = cook(kind, n, m, false, settings);
        table.relative("Cook's membrane, plane stress, " + name(kind) + " " + std::to_string(n) + " x " + std::to_string(n) + ": middle of the edge [m/N]", 23.96, fine,
                       kind == Kind::tets ? 0.03 : 0.01, std::log2((23.965 - coarse) / (23.965 - fine)));
        // Tets lock here unless their volumetric stiffness sits at the vertices; hexahedra have their inner modes.
        const Material rubber = Linear{.young_pa = 1, .poisson = 0.4999, .volumetric = Volumetric::nodal};
        const double rough = cook(kind, n / 2, rubber, true, settings), smooth = cook(kind, n, rubber, true, settings);
        table.relative("Cook's membrane, plane strain, nu = .4999, " + name(kind) + " " + std::to_string(n) + " x " + std::to_string(n) + ": middle of the edge [m/N]", 18.5, smooth, 0.05,
                       std::log2((18.5 - rough) / (18.5 - smooth)));
    }
    table.note("tets: cells cut along their shorter diagonal (along the longer one a mesh of 16 x 16 cells is 10 % stiff at nu = 1/3 and 15 % at nu = .4999: bending, not locking), volume at the "
               "vertices; hexahedra are as they are by default.");
}

// -- row 18 -----------------------------------------------------------------------------------------------

/// Kirsch's stress for a hole of radius 1 in an infinite plate under tension 1 along x.
Mat3 kirsch(const Vec3& X) {
    const double r2 = X.x() * X.x() + X.y() * X.y(), t = std::atan2(X.y(), X.x()), a = 1 / r2, b = a * a, c2 = std::cos(2 * t), c4 = std::cos(4 * t), s2 = std::sin(2 * t),
                 s4 = std::sin(4 * t);
    Mat3 s = Mat3::Zero();
    s(0, 0) = 1 - a * (1.5 * c2 + c4) + 1.5 * b * c4;
    s(1, 1) = -a * (0.5 * c2 - c4) - 1.5 * b * c4;
    s(0, 1) = s(1, 0) = -a * (0.5 * s2 + s4) + 1.5 * b * s4;
    return s;
}

/// A quarter of the plate to x, y <= 4: two patches around the hole, denser towards it; two layers, for patch recovery wants vertices inside.
VolumeMesh plate_with_hole(Kind kind, int n, double thickness) {
    const auto sector = [&](bool upper) {
        return mapped_box(kind, {n, n, 2}, [=](const Vec3& s) {
            const double around = (upper ? 1 + s.y() : s.y()) * M_PI / 4;
            const Vec3 hole(std::cos(around), std::sin(around), 0);
            const Vec3 edge = upper ? Vec3(4 / std::tan(around), 4, 0) : Vec3(4, 4 * std::tan(around), 0);
            return Vec3(hole + graded(s.x(), 20) * (edge - hole) + Vec3(0, 0, thickness * s.z()));
        });
    };
    return welded({sector(false), sector(true)});
}

void plate_hole(Table& table, const Settings& settings) {
    for (const Kind kind : element_kinds()) {
        const int n = kind == Kind::tets ? 32 : 16;
        Statics plate(plate_with_hole(kind, n, 0.1), Linear{.young_pa = kYoung, .poisson = 0.3}, {.threads = settings.threads});
        for (int axis = 0; axis < 3; ++axis) plate.hold(on_plane(axis, 0), {.x = axis == 0, .y = axis == 1, .z = axis == 2});
        const double tension = 10;
        for (int axis = 0; axis < 2; ++axis)
            plate.load(traction_forces(plate.mesh(), on_plane(axis, 4), [&](const Vec3& X, const Vec3& normal) -> Vec3 { return tension * (kirsch(X) * normal); }));
        plate.solve();
        const double peak = von_mises(plate.stress_at(Vec3(0, 1, 0))) / tension;
        table.relative("plate with a hole, " + name(kind) + ": peak von Mises / tension", 3, peak, 0.03);
        const auto vertices = plate.nodal_stress();
        const double error = stress_error(plate.mesh(), vertices, {}, [&](const Vec3& X) -> Mat3 { return tension * kirsch(X); });
        table.below("plate with a hole, " + name(kind) + ": L2 error of the stress", error, 0.03);
    }
}

const RegisterCase row5({5, "patch test", false, patch_test});
const RegisterCase row14({14, "Cook's membrane", false, cooks_membrane});
const RegisterCase row18({18, "plate with a hole", false, plate_hole});

}  // namespace
}  // namespace supple::verify
