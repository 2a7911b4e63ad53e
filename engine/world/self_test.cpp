#include "supple/world/self_test.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

#include "supple/math/polar.h"
#include "supple/world/evaluate.h"

namespace supple {

namespace {

/// The same numbers on every machine (splitmix64, G. Steele et al. 2014).
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    double uniform() {  // [-1, 1)
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return 2 * (double((z ^ (z >> 31)) >> 11) * 0x1p-53) - 1;
    }
    Mat3 matrix() {
        Mat3 A;
        for (int i = 0; i < 9; ++i) A(i / 3, i % 3) = uniform();
        return A;
    }

private:
    std::uint64_t state_;
};

constexpr double kStep = 1e-6;  // difference step [m]

/// The stretch where a hyperelastic law's extension begins (material/laws/inversion.h).
double floor_of(const Material& material) { return std::holds_alternative<VerondaWestman>(material) || std::holds_alternative<Costa>(material) ? 0.3 : 0.1; }

/// Whether energy and force are smooth around F.
bool is_smooth(const Mat3& F, const Material& material) {
    const Vec3 s = F.jacobiSvd().singularValues();
    const double third = F.determinant() < 0 ? -s[2] : s[2];
    if (s[1] + third < 0.1) return false;
    const double floor = floor_of(material);
    return !is_hyperelastic(material) || (std::abs(s[1] - floor) > 2e-3 && std::abs(third - floor) > 2e-3);
}

/// Laws with ln J go on below the floor by an extension whose tangent leaves out third derivatives of the energy (material/laws/inversion.h).
bool is_extended(const Material& material) {
    return is_hyperelastic(material) && !std::holds_alternative<StVenantKirchhoff>(material) && !std::holds_alternative<StableNeoHookean>(material);
}

double least_stretch(const Mat3& F) {
    const double s = F.jacobiSvd().singularValues()[2];
    return F.determinant() < 0 ? -s : s;
}

enum class Directions { all, unturned, triangular };

struct UnitTet {
    std::shared_ptr<const BodyTemplate> shape;

    UnitTet() {
        VolumeMesh mesh;
        mesh.vertices = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
        mesh.tets = {{0, 1, 2, 3}};
        shape = BodyTemplate::build(std::move(mesh));
    }
    static std::vector<Vec3> at(const Mat3& F) { return {Vec3::Zero(), F.col(0), F.col(1), F.col(2)}; }
};

double largest(const std::vector<Vec3>& f) {
    double size = 0;
    for (const Vec3& v : f) size = std::max(size, v.norm());
    return size;
}

double force_error(const UnitTet& tet, const Material& material, const Mat3& F, double scale) {
    const std::vector<Vec3> x = UnitTet::at(F), f = evaluate(*tet.shape, material, x).forces_n;
    double error = 0;
    for (std::size_t v = 0; v < 4; ++v) {
        for (int c = 0; c < 3; ++c) {
            std::vector<Vec3> up = x, down = x;
            up[v][c] += kStep;
            down[v][c] -= kStep;
            const double slope = (evaluate(*tet.shape, material, up).energy_j - evaluate(*tet.shape, material, down).energy_j) / (2 * kStep);
            error = std::max(error, std::abs(f[v][c] + slope));
        }
    }
    return error / std::max(largest(f), scale);
}

Mat3 frame_of_edges(const Mat3& F) {
    Mat3 R;
    R.col(0) = F.col(0).normalized();
    R.col(2) = F.col(0).cross(F.col(1)).normalized();
    R.col(1) = R.col(2).cross(R.col(0));
    return R;
}

double tangent_error(const UnitTet& tet, const Material& material, const Mat3& F, Mat3 direction, Directions directions, double scale) {
    if (directions == Directions::unturned) direction = rotation_matrix(polar_quaternion(F)) * Mat3(0.5 * (direction + direction.transpose()));
    if (directions == Directions::triangular) direction = frame_of_edges(F) * Mat3(direction.triangularView<Eigen::Upper>());
    const std::vector<Vec3> up = evaluate(*tet.shape, material, UnitTet::at(F + kStep * direction)).forces_n,
                            down = evaluate(*tet.shape, material, UnitTet::at(F - kStep * direction)).forces_n;
    const Tangent tangent = directions == Directions::all ? Tangent::exact : Tangent::automatic;
    const std::vector<Vec3> df = force_differential(*tet.shape, material, UnitTet::at(F), UnitTet::at(direction), tangent);
    double error = 0;
    for (std::size_t v = 0; v < 4; ++v) error = std::max(error, (df[v] - (up[v] - down[v]) / (2 * kStep)).norm());
    return error / std::max(largest(df), scale);
}

}  // namespace

DerivativeCheck check_derivatives(const Material& material, std::size_t samples, std::uint64_t seed) {
    const Lame lame = small_strain(material);
    const double scale = 1e-3 * (std::abs(lame.lambda_pa) + 2 * lame.mu_pa);  // forces below it are noise
    const auto* corotational = std::get_if<Corotational>(&material);
    const bool large = corotational != nullptr && corotational->rotation == Rotation::large;
    DerivativeCheck check;
    check.has_energy = !large;
    check.tangent = large                     ? "warped, in directions that do not turn the element"
                    : corotational != nullptr ? "exact in every direction, and warped in directions that do not turn the element"
                    : is_extended(material)   ? "exact in every direction, where no stretch is below the floor of the law's extension"
                                              : "exact in every direction";
    const UnitTet tet;
    Random random(seed);
    for (std::size_t tried = 0; check.samples < samples && tried < 100 * samples; ++tried) {
        // A third near rest, a third far from it, a third inside out.
        const double size = tried % 3 == 0 ? 0.3 : 0.8;
        Mat3 F = Mat3::Identity() + size * random.matrix();
        const bool inverted = tried % 3 == 2;
        if (inverted) F.col(int(tried) % 9 / 3) *= -0.4;
        const Mat3 direction = random.matrix();
        if ((F.determinant() < 0) != inverted || !is_smooth(F, material)) continue;
        if (large && (F.col(0).norm() < 0.1 || F.col(0).cross(F.col(1)).norm() < 0.05)) continue;
        ++check.samples;
        const double force = large ? 0 : force_error(tet, material, F, scale);
        double tangent = 0;
        const bool has_exact = !large && !(is_extended(material) && least_stretch(F) < floor_of(material));
        if (has_exact) tangent = tangent_error(tet, material, F, direction, Directions::all, scale);
        if (corotational != nullptr)
            tangent = std::max(tangent, tangent_error(tet, material, F, direction, large ? Directions::triangular : Directions::unturned, scale));
        if (!(force <= check.force_error)) {
            check.force_error = force;
            check.worst_force_at = F;
        }
        if (!(tangent <= check.tangent_error)) {
            check.tangent_error = tangent;
            check.worst_tangent_at = F;
        }
    }
    return check;
}

}  // namespace supple
