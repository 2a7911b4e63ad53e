#include "supple/world/inspect.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>

#include "supple/base/error.h"
#include "supple/fem/element_geometry.h"
#include "supple/math/polar.h"
#include "supple/world/evaluate.h"
#include "supple/world/impl.h"

namespace supple {

namespace {

/// Columns: x along the first edge, z across the plane of the first two, y completes.
Mat3 edge_frame(const Vec3& first, const Vec3& second) {
    Mat3 frame;
    frame.col(0) = first.stableNormalized();
    frame.col(2) = frame.col(0).cross(second).stableNormalized();
    frame.col(1) = frame.col(2).cross(frame.col(0));
    return frame;
}

bool in_edge_frame(const Material& material) {
    const auto* corotational = std::get_if<Corotational>(&material);
    return corotational != nullptr && corotational->rotation == Rotation::large;
}

Mat3 frame_at(const fem::ElementGeometry& g, std::span<const Vec3> x) {
    const auto at = [&](std::size_t a) -> const Vec3& { return x[std::size_t(g.vertex[a])]; };
    return edge_frame(at(1) - at(0), at(g.corners == 4 ? 2 : 3) - at(0));
}

Mat3 rotation_of(const Material& material, const fem::ElementGeometry& g, std::span<const Vec3> rest, std::span<const Vec3> now) {
    if (std::holds_alternative<Linear>(material)) return Mat3::Identity();
    if (in_edge_frame(material)) return frame_at(g, now) * frame_at(g, rest).transpose();
    return rotation_matrix(polar_quaternion(g.deformation_gradient(now)));
}

MatX strain_displacement(const fem::ElementGeometry& g) {
    MatX B = MatX::Zero(6, Eigen::Index(3 * g.corners));
    for (std::size_t a = 0; a < g.corners; ++a) {
        const Vec3& d = g.gradient[a];
        const auto c = Eigen::Index(3 * a);
        for (int i = 0; i < 3; ++i) B(i, c + i) = d[i];
        for (int i = 0; i < 3; ++i) {  // xy yz zx
            const int j = (i + 1) % 3;
            B(3 + i, c + i) = d[j];
            B(3 + i, c + j) = d[i];
        }
    }
    return B;
}

Mat6 isotropic_matrix(const Lame& lame) {
    Mat6 D = Mat6::Zero();
    D.topLeftCorner<3, 3>().setConstant(lame.lambda_pa);
    for (int i = 0; i < 3; ++i) {
        D(i, i) += 2 * lame.mu_pa;
        D(3 + i, 3 + i) = lame.mu_pa;
    }
    return D;
}

/// A body of one element alone, so that any law and kind answers through evaluate() and force_differential().
struct LoneElement {
    std::shared_ptr<const BodyTemplate> shape;
    Material material;

    LoneElement(const VolumeMesh& mesh, const fem::ElementGeometry& g, Material law) : material(std::move(law)) {
        VolumeMesh one;
        for (std::size_t a = 0; a < g.corners; ++a) one.vertices.push_back(mesh.vertices[std::size_t(g.vertex[a])]);
        if (g.corners == 4) {
            one.tets = {{0, 1, 2, 3}};
        } else {
            one.hexes = {{0, 1, 2, 3, 4, 5, 6, 7}};
        }
        shape = BodyTemplate::build(std::move(one));
    }

    MatX stiffness(const std::vector<Vec3>& x, Tangent tangent) const {
        const auto n = Eigen::Index(3 * x.size());
        MatX K(n, n);
        for (Eigen::Index c = 0; c < n; ++c) {
            std::vector<Vec3> d(x.size(), Vec3::Zero());
            d[std::size_t(c / 3)][c % 3] = 1;
            const std::vector<Vec3> df = force_differential(*shape, material, x, d, tangent);
            for (Eigen::Index r = 0; r < n; ++r) K(r, c) = -df[std::size_t(r / 3)][r % 3];
        }
        return K;
    }
};

/// The material of one element as that of a body of it alone; the element's stiffness factor is left out.
Material material_of(const Body& body, std::size_t element) {
    Material material = body.materials.of(element);
    std::visit(
        [&](auto& m) {
            if constexpr (requires { m.fibres; }) {
                for (auto* directions : {&m.fibres.fibre, &m.fibres.sheet}) {
                    if (directions->size() > 1) *directions = {(*directions)[element]};
                }
            }
        },
        material);
    return material;
}

}  // namespace

Inspector::Inspector(const World& world, BodyId body) : world_(&world), body_(body) { world.impl_->body(body); }

std::size_t Inspector::element_count() const { return world_->shape(body_).mesh().element_count(); }

Eigen::Index Inspector::rows() const { return Eigen::Index(3 * world_->positions(body_).size()); }

ElementView Inspector::element(std::size_t index) const {
    if (index >= element_count()) {
        throw Error(ErrorCode::invalid_argument, "Inspector::element",
                    std::to_string(index) + " is no element of \"" + world_->name(body_) + "\"; it has " + std::to_string(element_count()) + ", counted from 0");
    }
    const Body& body = world_->impl_->body(body_);
    const VolumeMesh& mesh = body.data().mesh;
    const std::vector<Vec3>& x = body.state.x;
    const fem::ElementGeometry g = fem::element_geometry(mesh, index);
    ElementView view;
    view.vertices.assign(g.vertex.begin(), g.vertex.begin() + std::ptrdiff_t(g.corners));
    view.rest_volume_m3 = g.volume;
    view.deformation_gradient = g.deformation_gradient(x);
    const Material& material = body.materials.of(index);
    view.initial_rotation = in_edge_frame(material) ? frame_at(g, mesh.vertices) : Mat3(Mat3::Identity());
    view.rotation = rotation_of(material, g, mesh.vertices, x);
    std::vector<Vec3> rest, now;
    for (const std::int32_t v : view.vertices) {
        rest.push_back(mesh.vertices[std::size_t(v)]);
        now.push_back(x[std::size_t(v)]);
        view.rest_shape_m.push_back(rest.back() - g.centre);
        view.rotated_rest_shape_m.push_back(view.rotation * view.rest_shape_m.back());
    }
    const LoneElement lone(mesh, g, material_of(body, index));
    view.strain_displacement = strain_displacement(g);
    view.material_matrix = isotropic_matrix(body.materials.lame_of(index));
    view.initial_stiffness = body.materials.factor(index) * lone.stiffness(rest, Tangent::automatic);
    view.stiffness = body.materials.factor(index) * lone.stiffness(now, in_edge_frame(material) ? Tangent::warped : world_->def().solver.tangent);
    update_stress(body, world_->impl_->alone);
    view.energy_j = body.stress.element_energy[index];
    view.cauchy_pa = body.stress.element[index];
    return view;
}

std::vector<Mat3> Inspector::element_rotations() const {
    const Body& body = world_->impl_->body(body_);
    std::vector<Mat3> rotations;
    for (std::size_t e = 0; e < element_count(); ++e) {
        rotations.push_back(rotation_of(body.materials.of(e), fem::element_geometry(body.data().mesh, e), body.data().mesh.vertices, body.state.x));
    }
    return rotations;
}

std::vector<Mat3> Inspector::vertex_rotations() const {
    const Body& body = world_->impl_->body(body_);
    const std::vector<Mat3> rotations = element_rotations();
    std::vector<Mat3> sum(body.vertices(), Mat3::Zero());
    for (std::size_t e = 0; e < rotations.size(); ++e) {
        const fem::ElementGeometry g = fem::element_geometry(body.data().mesh, e);
        for (std::size_t a = 0; a < g.corners; ++a) sum[std::size_t(g.vertex[a])] += g.volume * rotations[e];
    }
    for (Mat3& m : sum) m = m.isZero(0) ? Mat3(Mat3::Identity()) : rotation_matrix(polar_quaternion(m / m.norm()));
    return sum;
}

BoundingBox Inspector::bounding_box() const {
    const Body& body = world_->impl_->body(body_);
    BoundingBox box{Vec3::Constant(HUGE_VAL), Vec3::Constant(-HUGE_VAL)};
    for (std::size_t v = 0; v < body.vertices(); ++v) {
        if (body.mass[v] == 0) continue;
        box.min_m = box.min_m.cwiseMin(body.state.x[v]);
        box.max_m = box.max_m.cwiseMax(body.state.x[v]);
    }
    return box;
}

void Inspector::add(SystemMatrix which, double factor, Eigen::Index row0, Eigen::Index column0, MatrixSink sink) const {
    const Body& body = world_->impl_->body(body_);
    const solve::Bsr3Pattern& pattern = body.data().pattern;
    const SolverDef& solver = world_->def().solver;
    if (which == SystemMatrix::mass) {
        for (std::size_t i = 0; i < 3 * body.vertices(); ++i) sink(row0 + Eigen::Index(i), column0 + Eigen::Index(i), factor * body.mass[i / 3]);
        return;
    }
    const double of_mass = which == SystemMatrix::damping ? solver.rayleigh_mass_1_s : 0;
    const double of_stiffness = which == SystemMatrix::damping ? solver.rayleigh_stiffness_s : 1;
    // Elements of their own: in float64, not projected, and whatever the world's keep for the next step stays as it is.
    Team team;
    const auto elements = make_body_elements(body, fem::MatrixPrecision::double_, solver.tangent, Isa::scalar, false);
    AlignedVector<double> quaternion = body.state.quaternion, value(pattern.blocks() * 12);
    std::vector<double> shift(body.vertices());
    for (std::size_t row = 0; row < shift.size(); ++row) shift[row] = of_mass * body.mass[std::size_t(pattern.vertex[row])];
    fem::ElementOutputs outputs;
    outputs.tangent = true;
    outputs.plastic = plastic_strain(body);
    elements->evaluate(team, body.state.x.data()->data(), quaternion.data(), outputs);
    elements->assemble(team, of_stiffness, shift, value.data());
    if (elements->is_coupled() && of_stiffness != 0) {
        // The part that is too wide for the pattern, column by column.
        const std::size_t n = body.vertices();
        AlignedVector<double> unit(4 * n, 0.0), image(4 * n);
        for (std::size_t c = 0; c < 3 * n; ++c) {
            unit[c / 3 * 4 + c % 3] = 1;
            std::fill(image.begin(), image.end(), 0.0);
            elements->couple(team, factor * of_stiffness, unit.data(), image.data());
            unit[c / 3 * 4 + c % 3] = 0;
            for (std::size_t r = 0; r < 3 * n; ++r) {
                if (const double v = image[r / 3 * 4 + r % 3]; v != 0) sink(row0 + Eigen::Index(r), column0 + Eigen::Index(c), v);
            }
        }
    }
    for (std::size_t row = 0; row < body.vertices(); ++row) {
        const Eigen::Index vertex = pattern.vertex[row];
        for (Eigen::Index i = 0; i < 3; ++i) {
            for (std::int32_t b = pattern.row_start[row]; b < pattern.row_start[row + 1]; ++b) {
                const Eigen::Index other = pattern.vertex[std::size_t(pattern.column[std::size_t(b)])];
                for (Eigen::Index j = 0; j < 3; ++j) {
                    sink(row0 + 3 * vertex + i, column0 + 3 * other + j, factor * value[std::size_t(b) * 12 + std::size_t(4 * j + i)]);
                }
            }
        }
    }
}

namespace {

void require_room(Eigen::Index rows, Eigen::Index columns, Eigen::Index row0, Eigen::Index column0, Eigen::Index size) {
    if (row0 >= 0 && column0 >= 0 && row0 + size <= rows && column0 + size <= columns) return;
    throw Error(ErrorCode::invalid_argument, "Inspector::add_to",
                "a matrix of " + std::to_string(rows) + " x " + std::to_string(columns) + " has no room for " + std::to_string(size) + " x " + std::to_string(size) +
                    " at (" + std::to_string(row0) + ", " + std::to_string(column0) + "); make it larger, or move the offset");
}

}  // namespace

void Inspector::add_to(SystemMatrix which, double factor, Eigen::Index row0, Eigen::Index column0, Eigen::SparseMatrix<double>& matrix) const {
    require_room(matrix.rows(), matrix.cols(), row0, column0, rows());
    std::vector<Eigen::Triplet<double>> triplets;
    add(which, factor, row0, column0, [&](Eigen::Index r, Eigen::Index c, double v) { triplets.emplace_back(int(r), int(c), v); });
    Eigen::SparseMatrix<double> part(matrix.rows(), matrix.cols());
    part.setFromTriplets(triplets.begin(), triplets.end());
    matrix += part;
}

void Inspector::add_to(SystemMatrix which, double factor, Eigen::Index row0, Eigen::Index column0, Eigen::Ref<MatX> matrix) const {
    require_room(matrix.rows(), matrix.cols(), row0, column0, rows());
    add(which, factor, row0, column0, [&](Eigen::Index r, Eigen::Index c, double v) { matrix(r, c) += v; });
}

Eigen::SparseMatrix<double> Inspector::matrix(SystemMatrix which) const {
    Eigen::SparseMatrix<double> m(rows(), rows());
    add_to(which, 1, 0, 0, m);
    return m;
}

}  // namespace supple
