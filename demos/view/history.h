#pragma once
#include <array>
#include <cstddef>
#include <vector>

namespace supple::demos::view {

/// The last numbers of a curve, oldest first; the memory is there from the beginning.
class History {
public:
    static constexpr std::size_t kLength = 240;  // frames

    void add(float value) {
        values_[next_] = value;
        next_ = (next_ + 1) % kLength;
        if (size_ < kLength) ++size_;
    }
    void clear() { next_ = size_ = 0; }
    std::size_t size() const { return size_; }
    float operator[](std::size_t i) const { return values_[(next_ + kLength - size_ + i) % kLength]; }
    float last() const { return size_ > 0 ? (*this)[size_ - 1] : 0; }
    float largest() const {
        float most = 0;
        for (std::size_t i = 0; i < size_; ++i) most = (*this)[i] > most ? (*this)[i] : most;
        return most;
    }

private:
    std::array<float, kLength> values_{};
    std::size_t next_ = 0, size_ = 0;
};

}  // namespace supple::demos::view
