#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace supple {

/// Sets of 0 .. n-1 that grow together, n at most 2^32; each is named by its smallest member, whatever the order of the joins.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t n = 0) { reset(n); }

    /// n sets of one each. Allocates only to grow.
    void reset(std::size_t n) {
        parent_.resize(n);
        std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
    }
    /// The smallest member of the set that i is in; on the way, paths become shorter.
    std::size_t root(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) {
        a = root(a);
        b = root(b);
        parent_[std::max(a, b)] = std::uint32_t(std::min(a, b));
    }

private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace supple
