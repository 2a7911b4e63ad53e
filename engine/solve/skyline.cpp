#include "supple/solve/skyline.h"

#include <algorithm>
#include <cmath>

namespace supple::solve {

namespace {

/// Four sums side by side: lanes of a register, added in an order of their own.
double dot(const double* a, const double* b, std::size_t n) {
    double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    std::size_t i = 0;
    for (; i + 4 <= n; i += 4) {
        s0 += a[i] * b[i];
        s1 += a[i + 1] * b[i + 1];
        s2 += a[i + 2] * b[i + 2];
        s3 += a[i + 3] * b[i + 3];
    }
    for (; i < n; ++i) s0 += a[i] * b[i];
    return (s0 + s1) + (s2 + s3);
}

}  // namespace

void narrow_order(std::span<const std::int32_t> start, std::span<const std::int32_t> neighbour, std::vector<std::int32_t>& place, std::vector<std::int32_t>& queue) {
    const std::size_t n = start.size() - 1;
    const auto degree = [&](std::int32_t i) { return start[std::size_t(i) + 1] - start[std::size_t(i)]; };
    place.assign(n, -1);
    queue.clear();
    const auto spread = [&](std::int32_t root) {  // breadth first, small degrees first
        const std::size_t begin = queue.size();
        place[std::size_t(root)] = 0;
        queue.push_back(root);
        for (std::size_t at = begin; at < queue.size(); ++at) {
            const std::size_t from = queue.size();
            for (std::int32_t k = start[std::size_t(queue[at])]; k < start[std::size_t(queue[at]) + 1]; ++k) {
                const std::int32_t next = neighbour[std::size_t(k)];
                if (place[std::size_t(next)] >= 0) continue;
                place[std::size_t(next)] = 0;
                queue.push_back(next);
            }
            std::sort(queue.begin() + std::ptrdiff_t(from), queue.end(), [&](std::int32_t a, std::int32_t b) { return degree(a) != degree(b) ? degree(a) < degree(b) : a < b; });
        }
        return begin;
    };
    for (std::size_t i = 0; i < n; ++i) {
        if (place[i] >= 0) continue;
        const std::size_t begin = spread(std::int32_t(i));
        // Again from the far end: a root in the middle makes rows twice as long.
        const std::int32_t far = queue.back();
        for (std::size_t k = begin; k < queue.size(); ++k) place[std::size_t(queue[k])] = -1;
        queue.resize(begin);
        spread(far);
    }
    for (std::size_t k = 0; k < n; ++k) place[std::size_t(queue[k])] = std::int32_t(n - 1 - k);
}

void Skyline::shape(std::span<const std::int32_t> first) {
    first_.assign(first.begin(), first.end());
    row_.resize(first.size());
    std::size_t size = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        row_[i] = size;
        size += i + 1 - std::size_t(first[i]);
    }
    value_.assign(size, 0.0);
    inverse_diagonal_.resize(first.size());
}

bool Skyline::factor() {
    for (std::size_t i = 0; i < first_.size(); ++i) {
        const auto first = std::size_t(first_[i]);
        double* const row = value_.data() + row_[i];  // [column - first]
        double diagonal = row[i - first];
        for (std::size_t j = first; j < i; ++j) {
            const auto first_j = std::size_t(first_[j]), from = std::max(first, first_j);
            const double l = (row[j - first] - dot(row + (from - first), value_.data() + row_[j] + (from - first_j), j - from)) * inverse_diagonal_[j];
            row[j - first] = l;
            diagonal -= l * l;
        }
        if (!(diagonal > 0) || !std::isfinite(diagonal)) return false;
        row[i - first] = std::sqrt(diagonal);
        inverse_diagonal_[i] = 1 / row[i - first];
    }
    return true;
}

void Skyline::solve(double* x) const {
    for (std::size_t i = 0; i < first_.size(); ++i) {
        const auto first = std::size_t(first_[i]);
        x[i] = (x[i] - dot(value_.data() + row_[i], x + first, i - first)) * inverse_diagonal_[i];
    }
    for (std::size_t i = first_.size(); i-- > 0;) {
        const auto first = std::size_t(first_[i]);
        const double* const row = value_.data() + row_[i];
        x[i] *= inverse_diagonal_[i];
        for (std::size_t j = first; j < i; ++j) x[j] -= row[j - first] * x[i];
    }
}

std::size_t Skyline::bytes() const {
    return first_.capacity() * sizeof(std::int32_t) + row_.capacity() * sizeof(std::size_t) + (value_.capacity() + inverse_diagonal_.capacity()) * sizeof(double);
}

}  // namespace supple::solve
