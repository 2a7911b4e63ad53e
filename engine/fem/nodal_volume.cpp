#include "supple/fem/nodal_volume.h"

namespace supple::fem {

namespace {

constexpr std::size_t kUnscale = 7;  ///< where a record has what makes its vectors R g_a
constexpr std::size_t kVertexChunk = 512, kElementChunk = 512;

std::size_t vertex_at(const Tet4Rest& rest, std::size_t element, std::size_t corner) {
    return std::size_t(rest.vertex[(element / kBlock * 4 + corner) * kBlock + element % kBlock]);
}

}  // namespace

NodalVolume::NodalVolume(const Tet4Rest& rest, std::span<const double> excess)
    : rest_(rest), start_(rest.vertices + 1, 0), modulus_(rest.vertices, 0.0), element_(rest.blocks() * kBlock), vertex_(rest.vertices, 0.0), theta_(rest.vertices, 0.0) {
    for (std::size_t e = 0; e < rest.elements; ++e)
        for (std::size_t a = 0; a < 4; ++a) ++start_[vertex_at(rest, e, a) + 1];
    for (std::size_t v = 0; v < rest.vertices; ++v) start_[v + 1] += start_[v];
    corner_.resize(std::size_t(start_.back()));
    std::vector<std::int64_t> next(start_.begin(), start_.end() - 1);
    std::vector<double> volume(rest.vertices, 0.0);
    for (std::size_t e = 0; e < rest.elements; ++e) {
        for (std::size_t a = 0; a < 4; ++a) {
            const std::size_t v = vertex_at(rest, e, a);
            corner_[std::size_t(next[v]++)] = std::uint32_t(e * 4 + a);
            volume[v] += rest.volume[e] / 4;
            modulus_[v] += rest.volume[e] / 4 * excess[e];
        }
    }
    for (std::size_t v = 0; v < rest.vertices; ++v) modulus_[v] = volume[v] > 0 ? modulus_[v] / (volume[v] * volume[v]) : 0.0;
}

/// From (V_e/4) tr(e) in element_ to k_v theta_v, then to V_e p_e.
void NodalVolume::average(Team& team) {
    team.for_range(rest_.vertices, kVertexChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            double sum = 0;
            for (std::int64_t i = start_[v]; i < start_[v + 1]; ++i) sum += element_[corner_[std::size_t(i)] / 4];
            vertex_[v] = modulus_[v] * sum;
        }
    });
    team.for_range(rest_.elements, kElementChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) {
            double sum = 0;
            for (std::size_t a = 0; a < 4; ++a) sum += vertex_[vertex_at(rest_, e, a)];
            element_[e] = rest_.volume[e] / 4 * sum;
        }
    });
}

void NodalVolume::pressures(Team& team, const double* dilatation, double* pressure) {
    team.for_range(rest_.elements, kElementChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) element_[e] = rest_.volume[e] / 4 * dilatation[e];
    });
    team.for_range(rest_.vertices, kVertexChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            double sum = 0;
            for (std::int64_t i = start_[v]; i < start_[v + 1]; ++i) sum += element_[corner_[std::size_t(i)] / 4];
            theta_[v] = sum;  // theta_v V_v
        }
    });
    average(team);
    team.for_range(rest_.blocks() * kBlock, kElementChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) pressure[e] = e < rest_.elements ? element_[e] / rest_.volume[e] : 0.0;
    });
}

void NodalVolume::add_energy(double* energy) const {
    // k_v V_v theta_v^2/2 of each vertex, to its elements in equal parts.
    for (std::size_t v = 0; v < rest_.vertices; ++v) {
        const std::int64_t count = start_[v + 1] - start_[v];
        for (std::int64_t i = start_[v]; i < start_[v + 1]; ++i) energy[corner_[std::size_t(i)] / 4] += 0.5 * vertex_[v] * theta_[v] / double(count);
    }
}

template <class Real>
void NodalVolume::multiply_add(Team& team, const Real* record, double scale, const Real* x, Real* y) {
    team.for_range(rest_.elements, kElementChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) {
            double sum = 0;
            for (std::size_t a = 0; a < 4; ++a) {
                const Real* r = record + e * kRecord + 4 * a;
                const Real* p = x + 4 * vertex_at(rest_, e, a);
                sum += double(r[0] * p[0] + r[1] * p[1] + r[2] * p[2]);
            }
            element_[e] = rest_.volume[e] / 4 * double(record[e * kRecord + kUnscale]) * sum;
        }
    });
    average(team);
    team.for_range(rest_.vertices, kVertexChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            double sum[3] = {0, 0, 0};
            for (std::int64_t i = start_[v]; i < start_[v + 1]; ++i) {
                const std::uint32_t corner = corner_[std::size_t(i)];
                const Real* r = record + std::size_t(corner / 4) * kRecord + 4 * (corner & 3u);
                const double q = element_[corner / 4] * double(record[std::size_t(corner / 4) * kRecord + kUnscale]);
                for (int c = 0; c < 3; ++c) sum[c] += q * double(r[c]);
            }
            for (std::size_t c = 0; c < 3; ++c) y[4 * v + c] += Real(scale * sum[c]);
        }
    });
}

template <class Real>
void NodalVolume::add_diagonal(Team& team, const Real* record, std::span<Mat3> out) const {
    // K_v of vertex v has the row c_i = sum (V_e/4) g'_i over the elements that v and i share; its diagonal block at i is (k_v/V_v) c_i c_i^T.
    team.for_range(rest_.vertices, kVertexChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Mat3 sum = Mat3::Zero();
            for (std::int64_t k = start_[i]; k < start_[i + 1]; ++k) {
                for (std::size_t b = 0; b < 4; ++b) {
                    const std::size_t v = vertex_at(rest_, corner_[std::size_t(k)] / 4, b);
                    // Each v once: at its first shared element.
                    bool seen = false;
                    for (std::int64_t m = start_[i]; m < k && !seen; ++m)
                        for (std::size_t c = 0; c < 4 && !seen; ++c) seen = vertex_at(rest_, corner_[std::size_t(m)] / 4, c) == v;
                    if (seen) continue;
                    Vec3 row = Vec3::Zero();
                    for (std::int64_t m = k; m < start_[i + 1]; ++m) {
                        const std::uint32_t corner = corner_[std::size_t(m)];
                        const std::size_t e = corner / 4;
                        bool shared = false;
                        for (std::size_t c = 0; c < 4; ++c) shared |= vertex_at(rest_, e, c) == v;
                        const Real* r = record + e * kRecord + 4 * (corner & 3u);
                        if (shared) row += rest_.volume[e] / 4 * double(record[e * kRecord + kUnscale]) * Vec3(double(r[0]), double(r[1]), double(r[2]));
                    }
                    sum += modulus_[v] * row * row.transpose();
                }
            }
            out[i] += sum;
        }
    });
}

template void NodalVolume::multiply_add<float>(Team&, const float*, double, const float*, float*);
template void NodalVolume::multiply_add<double>(Team&, const double*, double, const double*, double*);
template void NodalVolume::add_diagonal<float>(Team&, const float*, std::span<Mat3>) const;
template void NodalVolume::add_diagonal<double>(Team&, const double*, std::span<Mat3>) const;

}  // namespace supple::fem
