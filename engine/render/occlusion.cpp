#include "supple/render/occlusion.h"

#include <algorithm>
#include <cmath>

namespace supple::render {

using Eigen::Vector3f;

namespace {

constexpr int kCells = 32;  // along the longest side
constexpr int kMargin = 4;  // empty cells around, a multiple of the coarsest cell

/// Three-tap blur of every row, twice in x and twice in z: [1 2 1] / 4, the border repeats.
void blur(std::vector<float>& field, std::vector<float>& scratch, int n) {
    scratch.resize(field.size());
    for (int pass = 0; pass < 2; ++pass) {
        for (int z = 0; z < n; ++z)
            for (int x = 0; x < n; ++x) {
                const float* row = &field[std::size_t(z * n)];
                // Written transposed: the second pass then blurs the other direction and puts it back.
                scratch[std::size_t(x * n + z)] = 0.25f * row[std::max(x - 1, 0)] + 0.5f * row[x] + 0.25f * row[std::min(x + 1, n - 1)];
            }
        field.swap(scratch);
    }
}

}  // namespace

void OcclusionGrid::reset(const Vector3f& low, const Vector3f& high) {
    const Vector3f extent = (high - low).cwiseMax(0);
    const float cell = std::max(extent.maxCoeff(), 1e-12f) / kCells;
    origin_ = low - Vector3f::Constant(kMargin * cell);
    Eigen::Array3i size;
    for (int k = 0; k < 3; ++k) size[k] = (int(std::ceil(extent[k] / cell)) + 2 * kMargin + 4) / 4 * 4;
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        levels_[l].size = size / (1 << l);
        levels_[l].cell = cell * float(1 << l);
        levels_[l].opacity.assign(std::size_t(levels_[l].size.prod()), 0.0f);
    }
}

void OcclusionGrid::drop(const Vector3f& point, float area) {
    Level& level = levels_[0];
    const Vector3f p = ((point - origin_) / level.cell - Vector3f::Constant(0.5f)).cwiseMax(0);
    const int x = std::min(int(p.x()), level.size.x() - 2), y = std::min(int(p.y()), level.size.y() - 2),
              z = std::min(int(p.z()), level.size.z() - 2);
    const float fx = p.x() - float(x), fy = p.y() - float(y), fz = p.z() - float(z);
    const float amount = area / (level.cell * level.cell);
    for (int k = 0; k < 8; ++k)
        level.at(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)) +=
            amount * (k & 1 ? fx : 1 - fx) * (k & 2 ? fy : 1 - fy) * (k & 4 ? fz : 1 - fz);
}

void OcclusionGrid::add(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
    const float area = 0.5f * (b - a).cross(c - a).norm();
    if (!(area > 0)) return;
    // Triangles larger than a cell are dropped in n^2 equal pieces, at the middle of each piece.
    const float cell = levels_[0].cell;
    const float longest = std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    const int n = std::clamp(int(std::ceil(longest / cell)), 1, 2 * kCells);
    const float piece = area / float(n * n);
    const Vector3f u = (b - a) / float(n), v = (c - a) / float(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
            const Vector3f corner = a + float(i) * u + float(j) * v;
            drop(corner + (u + v) / 3, piece);
            if (i + j < n - 1) drop(corner + (u + v) * (2.0f / 3), piece);
        }
}

void OcclusionGrid::finish() {
    for (std::size_t l = 1; l < levels_.size(); ++l) {
        Level &fine = levels_[l - 1], &coarse = levels_[l];
        for (int z = 0; z < coarse.size.z(); ++z)
            for (int y = 0; y < coarse.size.y(); ++y)
                for (int x = 0; x < coarse.size.x(); ++x) {
                    float sum = 0;
                    for (int k = 0; k < 8; ++k) sum += fine.at(2 * x + (k & 1), 2 * y + (k >> 1 & 1), 2 * z + (k >> 2));
                    coarse.at(x, y, z) = sum / 4;  // area adds up, and a coarse cell is four times wider in area
                }
    }
}

float OcclusionGrid::Level::sample(const Vector3f& p) const {
    const Vector3f q = p - Vector3f::Constant(0.5f);
    if (!(q.x() > 0 && q.y() > 0 && q.z() > 0)) return 0;
    const int x = int(q.x()), y = int(q.y()), z = int(q.z());
    if (x > size.x() - 2 || y > size.y() - 2 || z > size.z() - 2) return 0;
    const float fx = q.x() - float(x), fy = q.y() - float(y), fz = q.z() - float(z);
    const int dy = size.x(), dz = size.x() * size.y();
    const float* c = &opacity[std::size_t(z * dz + y * dy + x)];
    const float low = (c[0] * (1 - fx) + c[1] * fx) * (1 - fy) + (c[dy] * (1 - fx) + c[dy + 1] * fx) * fy;
    const float high = (c[dz] * (1 - fx) + c[dz + 1] * fx) * (1 - fy) + (c[dz + dy] * (1 - fx) + c[dz + dy + 1] * fx) * fy;
    return low * (1 - fz) + high * fz;
}

float OcclusionGrid::openness(const Vector3f& point, const Vector3f& normal) const {
    // A flat surface sees a little of itself, since its matter is spread over two cells: that much is taken off. Weights are tuned by eye.
    constexpr float kWeight[3] = {0.55f, 0.50f, 0.40f}, kReach = 1.25f, kOwn = 0.08f;
    float closed = 0;
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        const Vector3f p = (point - origin_) / levels_[l].cell + kReach * normal;
        closed += kWeight[l] * std::max(0.0f, levels_[l].sample(p) - kOwn);
    }
    return std::exp(-closed);
}

void OcclusionGrid::ground(float height, std::vector<std::uint8_t>& openness_out) {
    // A sheet of light sinks from the top of the grid to the ground; every layer of matter takes its share, and between the layers the
    // light spreads sideways. Cells of twice the width leave room for the spread around the body.
    Level& level = levels_[1];
    constexpr int n = kGroundSize;
    const float cell = level.cell;
    const int pad_x = (n - level.size.x()) / 2, pad_z = (n - level.size.z()) / 2;
    ground_low_ = Eigen::Vector2f(origin_.x() - float(pad_x) * cell, origin_.z() - float(pad_z) * cell);
    ground_high_ = ground_low_ + Eigen::Vector2f::Constant(n * cell);
    light_.assign(std::size_t(n * n), 1.0f);
    const int lowest = std::clamp(int(std::floor((height - origin_.y()) / cell)), -24, level.size.y());
    for (int y = level.size.y() - 1; y >= lowest; --y) {
        if (y >= 0)
            for (int z = 0; z < level.size.z(); ++z)
                for (int x = 0; x < level.size.x(); ++x)
                    light_[std::size_t((z + pad_z) * n + x + pad_x)] *= std::exp(-0.9f * level.at(x, y, z));
        blur(light_, blurred_, n);
    }
    openness_out.resize(light_.size());
    std::transform(light_.begin(), light_.end(), openness_out.begin(),
                   [](float v) { return std::uint8_t(std::lround(255 * std::clamp(v, 0.0f, 1.0f))); });
}

}  // namespace supple::render
