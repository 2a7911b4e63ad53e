#include "supple/world/element_operator.h"

#include <algorithm>

#include "supple/world/precondition.h"

namespace supple {

template <class Real>
void ElementOperator<Real>::update(StepContext& ctx, Body& body) {
    const std::size_t n = body.vertices();
    const std::vector<std::int32_t>& vertex = body.data().pattern.vertex;
    const double mass = mass_scale(ctx, body);
    mass_.resize(n);
    diagonal_.resize(12 * n);
    for (std::size_t row = 0; row < n; ++row) mass_[row] = Real(mass * body.mass[std::size_t(vertex[row])]);
    held_.clear();
    for (const std::int32_t row : body.held_rows) {
        std::uint8_t axes = 0;
        for (std::size_t c = 0; c < 3; ++c) axes = std::uint8_t(axes | (body.is_held(std::size_t(vertex[std::size_t(row)]), c) ? 1u << c : 0u));
        if (axes != 0) held_.push_back({row, axes});
    }
    products_ = body.elements->products(ctx.team, body.state.quaternion.data(), stiffness_scale(ctx, body), Real(0));
    products_->diagonal(ctx.team, mass_.data(), diagonal_.data());
    for (const Held& held : held_) {
        Real* block = diagonal_.data() + 12 * std::size_t(held.row);
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < 3; ++i) {
                if ((held.axes >> c & 1) || (held.axes >> i & 1)) block[4 * c + i] = Real(i == c ? 1 : 0);
            }
    }
}

template <class Real>
void ElementOperator<Real>::begin_product(Team& team, const Real* x) {
    products_->multiply(team, x);
}

template <class Real>
double ElementOperator<Real>::product_rows(const Real* x, Real* y, std::size_t begin, std::size_t end) const {
    const double dot = products_->rows(mass_.data(), x, y, begin, end);  // x is zero where held: whatever y is there adds nothing
    auto at = std::lower_bound(held_.begin(), held_.end(), std::int32_t(begin), [](const Held& held, std::int32_t row) { return held.row < row; });
    for (; at != held_.end() && at->row < std::int32_t(end); ++at) {
        for (std::size_t c = 0; c < 3; ++c) {
            if (at->axes >> c & 1) y[4 * std::size_t(at->row) + c] = x[4 * std::size_t(at->row) + c];
        }
    }
    return dot;
}

template class ElementOperator<float>;
template class ElementOperator<double>;

bool solves_by_elements(const StepContext& ctx, const Body& body, const Island& island) {
    const SolverDef& def = ctx.world.def.solver;
    if (def.operator_kind == OperatorKind::assembled || !body.elements->has_products()) return false;
    // What asks for entries of the matrix: the preconditioner of several bodies, a factor, and tangents that are not projected (loads add to them, Newton looks for definiteness).
    if (!island.alone() || !body.work.project) return false;
    const auto kind = PreconditionerKind(body.state.solver[kMemoryKind]);
    if (kind == PreconditionerKind::direct) return false;
    if (def.precision == Precision::double_ && kind == PreconditionerKind::lattice_multigrid) return false;  // its smoother multiplies in float32
    return def.operator_kind == OperatorKind::matrix_free || body.elements->prefers_products();
}

}  // namespace supple
