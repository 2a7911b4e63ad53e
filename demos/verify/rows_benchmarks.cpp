// Rows 15 and 16: MacNeal and Harder's beams (Finite Elements in Analysis and Design 1, 3-20, 1985), the NAFEMS tests LE1, LE10 and LE11.
#include <cmath>

#include "quadrature.h"
#include "statics.h"
#include "table.h"

namespace supple::verify {
namespace {

// -- row 15 -----------------------------------------------------------------------------------------------

struct TipCase {
    std::string what;
    Vec3 force;
    double exact;
    double tolerance;
};

/// A beam of the unit box mapped to its shape, clamped at s.x = 0, loaded at s.x = 1.
void beam(Table& table, const std::string& name_of_beam, std::array<int, 3> cells, const Map& map, const Material& material, const std::vector<TipCase>& cases, const Settings& settings) {
    for (const TipCase& c : cases) {
        Statics body(mapped_box(Kind::hexes, cells, map), material, {.threads = settings.threads});
        const VolumeMesh unit = box(Kind::hexes, cells, Vec3::Ones());  // the same numbering
        const auto at_end = [&](double s) {
            std::vector<std::int32_t> list;
            for (std::size_t i = 0; i < unit.vertices.size(); ++i)
                if (std::abs(unit.vertices[i].x() - s) < 1e-9) list.push_back(std::int32_t(i));
            return list;
        };
        body.world().fix(body.body(), VertexList{at_end(0)});
        const double scale = 1 / c.exact;  // an answer well above rounding; the body is linear
        Load load;
        load.where = VertexList{at_end(1)};
        load.kind = LoadKind::total_force;
        // Equal forces at the corners of one layer of cells are consistent there; with more layers the difference dies out near the end.
        load.value.values = {Vec3(scale * c.force)};
        body.world().add_load(body.body(), load);
        body.solve();
        double sum = 0;
        for (const std::int32_t v : at_end(1)) sum += body.displacement(std::size_t(v)).dot(c.force) / double(at_end(1).size());
        table.relative(name_of_beam + " " + std::to_string(cells[0]) + " x " + std::to_string(cells[1]) + " x " + std::to_string(cells[2]) + ", hexes, " + c.what + ": tip",
                       c.exact, sum / scale, c.tolerance);
    }
}

void macneal_harder(Table& table, const Settings& settings) {
    beam(table, "straight beam", {6, 1, 1}, [](const Vec3& s) { return Vec3(6 * s.x(), 0.2 * s.y(), 0.1 * s.z()); }, Linear{.young_pa = 1e7, .poisson = 0.3},
         {{"extension", Vec3(1, 0, 0), 3.0e-5, 0.02}, {"in-plane shear", Vec3(0, 1, 0), 0.1081, 0.03}, {"out-of-plane shear", Vec3(0, 0, 1), 0.4321, 0.03}}, settings);
    // The curved beam needs more than the original six cells of 15 degrees: straight-sided, they miss the arc.
    beam(table, "curved beam", {36, 4, 2},
         [](const Vec3& s) {
             const double r = 4.12 + 0.2 * s.y(), a = (1 - s.x()) * M_PI / 2;
             return Vec3(r * std::sin(a), r * std::cos(a), 0.1 * s.z());
         },
         Linear{.young_pa = 1e7, .poisson = 0.25}, {{"in-plane shear", Vec3(0, 1, 0), 0.08734, 0.02}, {"out-of-plane shear", Vec3(0, 0, 1), 0.5022, 0.05}}, settings);
    beam(table, "twisted beam", {24, 4, 2},
         [](const Vec3& s) {
             const double a = s.x() * M_PI / 2, y = 1.1 * (s.y() - 0.5), z = 0.32 * (s.z() - 0.5);
             return Vec3(12 * s.x(), y * std::cos(a) - z * std::sin(a), y * std::sin(a) + z * std::cos(a));
         },
         Linear{.young_pa = 29e6, .poisson = 0.22}, {{"in-plane shear", Vec3(0, 0, 1), 0.005424, 0.02}, {"out-of-plane shear", Vec3(0, 1, 0), 0.001754, 0.02}}, settings);
}

// -- row 16 -----------------------------------------------------------------------------------------------

const Material kSteel = Linear{.young_pa = 210e9, .poisson = 0.3};

/// The quarter of the elliptic plate of LE1 and LE10, z from 0 to `thickness`; denser towards D = (2, 0).
VolumeMesh elliptic_plate(Kind kind, std::array<int, 3> cells, double thickness) {
    return mapped_box(kind, cells, [=](const Vec3& s) {
        const double a = graded(s.y(), 4) * M_PI / 2, t = graded(s.x(), 4);
        return Vec3((2 + 1.25 * t) * std::cos(a), (1 + 1.75 * t) * std::sin(a), thickness * s.z());
    });
}

bool on_outer_ellipse(const Vec3& X) { return std::abs(std::pow(X.x() / 3.25, 2) + std::pow(X.y() / 2.75, 2) - 1) < 1e-9; }

void le1(Table& table, const Settings& settings) {
    for (const Kind kind : element_kinds()) {
        const int n = kind == Kind::tets ? 32 : 24;
        Statics plate(elliptic_plate(kind, {n, n, 2}, 0.1), kSteel, {.threads = settings.threads});
        for (int axis = 0; axis < 3; ++axis) plate.hold(on_plane(axis, 0), {.x = axis == 0, .y = axis == 1, .z = axis == 2});
        // Tension of 10 MPa normal to the ellipse itself, not to the facets that stand for it.
        plate.load(traction_forces(plate.mesh(), on_outer_ellipse, [](const Vec3& X, const Vec3&) -> Vec3 {
            return 10e6 * Vec3(X.x() / (3.25 * 3.25), X.y() / (2.75 * 2.75), 0).normalized();
        }));
        plate.solve();
        table.relative("NAFEMS LE1, elliptic membrane, " + name(kind) + ": sigma_yy at D [MPa]", 92.7, plate.stress_at(Vec3(2, 0, 0))[1] / 1e6, kind == Kind::tets ? 0.05 : 0.03);
    }
}

void le10(Table& table, const Settings& settings) {
    for (const Kind kind : element_kinds()) {
        const int n = kind == Kind::tets ? 20 : 16;
        const double thickness = 0.6;
        Statics plate(elliptic_plate(kind, {n, n, kind == Kind::tets ? 12 : 8}, thickness), kSteel, {.threads = settings.threads, .preconditioner = PreconditionerKind::automatic});
        plate.hold(on_plane(1, 0), {.x = false, .y = true, .z = false});
        plate.hold(on_plane(0, 0), {.x = true, .y = false, .z = false});
        plate.hold(on_outer_ellipse, {.x = true, .y = true, .z = false});
        plate.hold([&](const Vec3& X) { return on_outer_ellipse(X) && std::abs(X.z() - thickness / 2) < 1e-9; }, {.x = false, .y = false, .z = true});
        plate.load(traction_forces(plate.mesh(), on_plane(2, thickness), [](const Vec3&, const Vec3&) { return Vec3(0, 0, -1e6); }));
        plate.solve();
        table.relative("NAFEMS LE10, thick plate, " + name(kind) + ": sigma_yy at D [MPa]", -5.38, plate.stress_at(Vec3(2, 0, thickness))[1] / 1e6, kind == Kind::tets ? 0.05 : 0.03);
    }
}

/// A meridian of LE11 in r, z: inner and outer profile over t in [0, 4], four parts of equal share.
std::array<double, 2> inner_profile(double t) {
    const double arc = std::min(t, 2.0) * M_PI / 8;
    if (t <= 2) return {std::cos(arc), std::sin(arc)};
    const double r = std::sqrt(0.5);
    return {r, r + (t - 2) / 2 * (1.79 - r)};
}

std::array<double, 2> outer_profile(double t) {
    const double arc = std::min(t, 1.0) * M_PI / 6, r = 1.4 * std::cos(M_PI / 6);
    if (t <= 1) return {1.4 * std::cos(arc), 1.4 * std::sin(arc)};
    if (t <= 3) return {r + (t - 1) / 2 * (1 - r), 0.7 + (t - 1) / 2 * (1.39 - 0.7)};
    return {1, 1.39 + (t - 3) * 0.4};
}

void le11(Table& table, const Settings& settings) {
    const double alpha = 2.3e-4, bulk = 210e9 / (3 * (1 - 2 * 0.3));
    const auto thermal = [=](const Vec3& X) { return 3 * bulk * alpha * (X.head<2>().norm() + X.z()); };  // pressure that would hold the expansion back
    for (const Kind kind : element_kinds()) {
        const int n = 8;
        Statics body(mapped_box(kind, {n, 4 * n, 3 * n},
                                [](const Vec3& s) {
                                    const auto in = inner_profile(4 * s.y()), out = outer_profile(4 * s.y());
                                    const double r = in[0] + graded(s.x(), 4) * (out[0] - in[0]), z = in[1] + graded(s.x(), 4) * (out[1] - in[1]), a = s.z() * M_PI / 2;
                                    return Vec3(r * std::cos(a), r * std::sin(a), z);
                                }),
                     kSteel, {.threads = settings.threads, .preconditioner = PreconditionerKind::automatic});
        for (int axis = 0; axis < 3; ++axis) body.hold(on_plane(axis, 0), {.x = axis == 0, .y = axis == 1, .z = axis == 2});
        body.hold(on_plane(2, 1.79), {.x = false, .y = false, .z = true});
        std::vector<Vec3> forces(body.mesh().vertices.size(), Vec3::Zero());
        for_each_point(body.mesh(), false, [&](const Point& p) {
            for (std::size_t a = 0; a < p.vertex.size(); ++a) forces[std::size_t(p.vertex[a])] += p.weight * thermal(p.X) * p.gradient[a];
        });
        body.load(forces);
        body.solve();
        // Mean over the circle through A, on which the stress is the same everywhere.
        double sum = 0;
        const auto circle = body.select([](const Vec3& X) { return std::abs(X.z()) < 1e-9 && std::abs(X.norm() - 1) < 1e-9; });
        for (const std::int32_t v : circle) sum += body.nodal_stress()[std::size_t(v)][2] - thermal(body.mesh().vertices[std::size_t(v)]);
        table.relative("NAFEMS LE11, cylinder, taper and sphere under temperature, " + name(kind) + ": sigma_zz at A [MPa]", -105, sum / double(circle.size()) / 1e6,
                       kind == Kind::tets ? 0.05 : 0.03);
    }
    table.note("the temperature acts through its equivalent nodal forces; the engine itself knows no temperature.");
}

const RegisterCase row15({15, "MacNeal-Harder beams", false, macneal_harder});
const RegisterCase row16a({16, "NAFEMS LE1", false, le1});
const RegisterCase row16b({16, "NAFEMS LE10", false, le10});
const RegisterCase row16c({16, "NAFEMS LE11", false, le11});

}  // namespace
}  // namespace supple::verify
