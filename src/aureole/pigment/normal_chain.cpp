// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/normal_chain.h"

namespace aureole::pigment {

using Eigen::MatrixXd;

NormalChainFactors::NormalChainFactors(const NormalChain& chain, double damping) : chain_(chain) {
  const std::size_t count = chain.blocks.size();
  solved_.resize(count);
  for (std::size_t l = 0; l < count; ++l) {
    MatrixXd block = chain.blocks[l], right = chain.to_border[l];
    block.diagonal() *= 1 + damping;
    if (l > 0) {
      const MatrixXd coupling = chain.coupling[l - 1].asDiagonal();
      block -= coupling * factors_.back().solve(coupling);
      right += coupling * solved_[l - 1];
    }
    factors_.emplace_back(block);
    if (factors_.back().info() != Eigen::Success) {
      good_ = false;
      return;
    }
    solved_[l] = factors_.back().solve(right);
  }
  backward(solved_);
  MatrixXd border = chain.border;
  border.diagonal() *= 1 + damping;
  for (std::size_t l = 0; l < count; ++l) border.noalias() -= chain.to_border[l].transpose() * solved_[l];
  border_ = border.llt();
  good_ = border_.info() == Eigen::Success;
}

void NormalChainFactors::solve(std::vector<MatrixXd>& blocks, MatrixXd& border) const {
  for (std::size_t l = 0; l < blocks.size(); ++l) {
    if (l > 0) blocks[l] += chain_.coupling[l - 1].asDiagonal() * blocks[l - 1];
    factors_[l].solveInPlace(blocks[l]);
  }
  backward(blocks);
  for (std::size_t l = 0; l < blocks.size(); ++l)
    border.noalias() -= chain_.to_border[l].transpose() * blocks[l];
  border_.solveInPlace(border);
  for (std::size_t l = 0; l < blocks.size(); ++l) blocks[l].noalias() -= solved_[l] * border;
}

void NormalChainFactors::backward(std::vector<MatrixXd>& y) const {
  for (std::size_t l = y.size(); l-- > 1;) {
    const MatrixXd right = chain_.coupling[l - 1].asDiagonal() * y[l];
    y[l - 1] += factors_[l - 1].solve(right);
  }
}

}  // namespace aureole::pigment
