#pragma once
#include <vector>

#include "supple/solve/joint_preconditioner.h"
#include "supple/world/body.h"

namespace supple {

/// A body in the step at work.
struct Member {
    BodyId id;
    Body* body = nullptr;
};

/// Bodies that touch, or are tied together, or share a collider that yields: one system for all of them. Most have one member.
struct Island {
    std::vector<Member> members;
    std::size_t rows = 0, elements = 0;
    bool same_matrices = false;  ///< since the last solve only what touches has changed
    StepReport report;           ///< of the island alone, where it is stepped beside others
    bool moved = false;          ///< there; if not, it has blown up

    bool alone() const { return members.size() == 1; }
};

/// What a linear solve is told and says, in the order of the rows: of an island, member by member.
struct RowFields {
    std::vector<Vec3> b, x, residual, guess[2];  ///< [row]
    void resize(std::size_t rows) {
        for (std::vector<Vec3>* field : {&b, &x, &residual, &guess[0], &guess[1]}) field->resize(rows);
    }
};

/// The system of an island of several members. Each keeps its matrix and its preconditioner.
template <class Real>
struct JointSystem {
    explicit JointSystem(Isa isa) : solver(0, isa), preconditioner(isa) {}

    solve::LinearSolver<Real> solver;
    solve::JointPreconditioner<Real> preconditioner;
    std::vector<solve::SystemPart<Real>> parts;
    std::vector<solve::JointPart<Real>> touching;  ///< the same, as the preconditioner sees them
};

}  // namespace supple
