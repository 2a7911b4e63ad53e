// Rows 10 to 13: cantilevers. Tets carry them in the plane (nu = 0, no displacement in z), where the beam's theory is exact and a fine mesh is cheap.
#include <array>
#include <cmath>

#include "quadrature.h"
#include "statics.h"
#include "table.h"

namespace supple::verify {
namespace {

constexpr double kYoung = 1e7, kHeight = 1, kWidth = 1;  // of the section [Pa, m]

/// A beam along x, its clamped end at 0, n cells over its height, one over its width. Tets may have their cells cut crosswise.
Statics plane_beam(Kind kind, double length, int n, const Material& material, StaticDef def, bool crossed = false) {
    const int along = int(std::lround(length / kHeight)) * n;
    const Vec3 size(length, kHeight, kWidth);
    Statics beam(crossed && kind == Kind::tets ? crossed_box({along, n}, size) : box(kind, {along, n, 1}, size), material, def);
    beam.hold(everywhere(), {.x = false, .y = false, .z = true});
    beam.hold(on_plane(0, 0));
    return beam;
}

constexpr double kInertia = kWidth * kHeight * kHeight * kHeight / 12;

std::vector<Vec3> tip_shear(const VolumeMesh& mesh, double length, double force) {
    return traction_forces(mesh, on_plane(0, length), [&](const Vec3&, const Vec3&) { return Vec3(0, -force / (kHeight * kWidth), 0); });
}

// -- row 10 -----------------------------------------------------------------------------------------------

double small_deflection(Kind kind, int n, const Settings& settings) {
    const double length = 10 * kHeight, force = 1e3;
    Statics beam = plane_beam(kind, length, n, Linear{.young_pa = kYoung, .poisson = 0}, {.threads = settings.threads});
    beam.load(tip_shear(beam.mesh(), length, force));
    beam.solve();
    return -beam.displacement(on_plane(0, length)).y() / force;
}

void small_cantilever(Table& table, const Settings& settings) {
    const double length = 10 * kHeight, k = 5.0 / 6, shear = kYoung / 2;
    const double exact = std::pow(length, 3) / (3 * kYoung * kInertia) + length / (k * shear * kHeight * kWidth);
    for (const Kind kind : element_kinds()) {
        const int n = kind == Kind::tets ? 8 : 2;
        const double coarse = small_deflection(kind, n, settings), middle = small_deflection(kind, 2 * n, settings), fine = small_deflection(kind, 4 * n, settings);
        const double order = std::log2((middle - coarse) / (fine - middle));
        table.relative("cantilever, tip load, L/h = 10, " + name(kind) + ", " + std::to_string(4 * n) + " over the height: tip [m/N]", exact, fine, 0.01, order);
        if (kind == Kind::tets) {
            table.order("the same: order in the tip", 2, order, 0.15);
            table.relative("the same, extrapolated from 16 and 32 cells", exact, fine + (fine - middle) / 3, 0.002);
        }
    }
}

// -- row 11 -----------------------------------------------------------------------------------------------

void large_tip_load(Table& table, const Settings& settings) {
    // Bisshopp and Drucker 1945.
    constexpr std::array<double, 6> load{1, 2, 3, 4, 5, 10}, down{.30172, .49346, .60325, .66996, .71379, .81061}, shortening{.05643, .16064, .25442, .32894, .38763, .55500};
    const double length = 20 * kHeight;
    for (const Kind kind : element_kinds()) {
        Statics beam = plane_beam(kind, length, kind == Kind::tets ? 8 : 4, Corotational{.young_pa = kYoung, .poisson = 0}, {.tolerance = 1e-6, .threads = settings.threads}, true);
        beam.load(tip_shear(beam.mesh(), length, kYoung * kInertia / (length * length)), {load.begin(), load.end()});
        for (std::size_t i = 0; i < load.size(); ++i) {
            beam.solve();
            const Vec3 u = beam.displacement(on_plane(0, length)) / length;
            const std::string what = "elastica, PL^2/EI = " + std::to_string(int(load[i])) + ", " + name(kind);
            const double tolerance = kind == Kind::tets ? 0.03 : 0.01;
            table.relative(what + ": drop / L", down[i], -u.y(), tolerance);
            table.relative(what + ": shortening / L", shortening[i], -u.x(), tolerance);
        }
    }
}

// -- row 12 -----------------------------------------------------------------------------------------------

void self_weight(Table& table, const Settings& settings) {
    constexpr std::array<double, 5> load{1, 2, 4, 8, 16}, down{.12347, .23851, .42516, .64063, .79702}, shortening{.00875, .03311, .10989, .27558, .49001};
    const double length = 20 * kHeight, area = kHeight * kWidth;
    for (const Kind kind : element_kinds()) {
        Statics beam = plane_beam(kind, length, kind == Kind::tets ? 10 : 4, Corotational{.young_pa = kYoung, .poisson = 0},
                                  {.tolerance = 1e-6, .threads = settings.threads, .density_kg_m3 = 1000}, true);
        for (std::size_t i = 0; i < load.size(); ++i) {
            beam.world().set_gravity(Vec3(0, -load[i] * kYoung * kInertia / (1000 * area * std::pow(length, 3)), 0));
            beam.solve();
            const Vec3 u = beam.displacement(on_plane(0, length)) / length;
            const std::string what = "own weight, rho g A L^3/EI = " + std::to_string(int(load[i])) + ", " + name(kind);
            table.relative(what + ": drop / L", down[i], -u.y(), 0.02);
            table.relative(what + ": shortening / L", shortening[i], -u.x(), 0.02);
        }
    }
}

// -- row 13 -----------------------------------------------------------------------------------------------

/// A moment of 2 pi EI/L rolls a beam up to a circle; a dead couple and a follower are the same in the plane.
void roll_up(Table& table, const Settings& settings) {
    const double length = 40 * kHeight, full = 2 * M_PI * kYoung * kInertia / length;
    const Kind kind = Kind::hexes;
    Statics beam = plane_beam(kind, length, 2, Corotational{.young_pa = kYoung, .poisson = 0}, {.tolerance = 1e-5, .threads = settings.threads});
    Load load;
    load.where = VertexList{beam.select(on_plane(0, length))};
    load.kind = LoadKind::moment;
    load.axis = Vec3::UnitZ();
    const int steps = 16;
    for (int k = 1; k <= steps; ++k) {
        load.amount.times_s.push_back(k);
        load.amount.values.push_back(full * k / steps);
    }
    beam.world().add_load(beam.body(), load);
    for (int k = 1; k <= steps; ++k) {
        beam.solve();
        if (k != steps / 2 && k != steps) continue;
        Vec3 tip = Vec3::Zero();
        const auto end = beam.select(on_plane(0, length));
        for (const std::int32_t v : end) tip += beam.x()[std::size_t(v)] / double(end.size());
        const Vec3 root(0, kHeight / 2, kWidth / 2);
        if (k == steps) table.below("roll-up by M = 2 pi EI/L, L/h = 40, " + name(kind) + ": gap / L", (tip - root).norm() / length, 0.02);
        else table.relative("half of it, " + name(kind) + ": height of the half circle / L", 2 / M_PI, (tip - root).y() / length, 0.02);
    }
}

const RegisterCase row10({10, "cantilever, small tip load", false, small_cantilever});
const RegisterCase row11({11, "cantilever, large tip load", true, large_tip_load});
const RegisterCase row12({12, "cantilever under its own weight", true, self_weight});
const RegisterCase row13({13, "roll-up under an end moment", false, roll_up});

}  // namespace
}  // namespace supple::verify
