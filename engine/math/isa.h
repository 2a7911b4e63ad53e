#pragma once
#include <string_view>

namespace supple {

/// Instruction sets that the kernels are compiled for. `scalar` is plain double arithmetic: the oracle of the others.
enum class Isa { scalar, baseline, avx2, avx512 };
inline constexpr Isa kAllIsas[] = {Isa::scalar, Isa::baseline, Isa::avx2, Isa::avx512};

bool is_supported(Isa isa);       ///< built in, and this processor has it
Isa best_isa();                   ///< the widest supported one
std::string_view name(Isa isa);   ///< "scalar", "baseline", "avx2", "avx512"

}  // namespace supple
