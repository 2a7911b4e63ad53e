#pragma once
#include <cstdint>

namespace supple {

/// A handle {index, generation}: cheap to copy, never dangling; a stale one gives Error(stale_id). Generation 0 is "none".
template <class Tag>
struct Id {
    std::uint32_t index = 0;
    std::uint32_t generation = 0;

    friend bool operator==(Id, Id) = default;
    explicit operator bool() const { return generation != 0; }
};

using BodyId = Id<struct BodyTag>;
using DragId = Id<struct DragTag>;

}  // namespace supple
