#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/aligned.h"
#include "supple/fem/element_products.h"
#include "supple/solve/operator.h"

namespace supple {

struct Body;
struct Island;
struct StepContext;

/// The matrix of a body that is not assembled: mass and stiffness by the products of its elements, held coordinates as in a matrix.
template <class Real>
class ElementOperator final : public solve::Operator<Real> {
public:
    /// Takes in the tangent of the last evaluation. The first call allocates.
    void update(StepContext& ctx, Body& body);

    void begin_product(Team& team, const Real* x) override;
    double product_rows(const Real* x, Real* y, std::size_t begin, std::size_t end) const override;
    std::span<const Real> diagonal() const override { return diagonal_; }
    double traffic() const override { return products_ == nullptr ? 0 : products_->traffic(); }

private:
    fem::ElementProducts<Real>* products_ = nullptr;
    AlignedVector<Real> mass_, diagonal_;
    struct Held {
        std::int32_t row;
        std::uint8_t axes;  ///< bit c: coordinate c
    };
    std::vector<Held> held_;  ///< ascending
};

/// Whether the solves of a body multiply by its elements instead of a matrix in this step. By the definitions and the choice of preconditioner, never by the clock.
bool solves_by_elements(const StepContext& ctx, const Body& body, const Island& island);

}  // namespace supple
