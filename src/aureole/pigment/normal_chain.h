// SPDX-License-Identifier: Apache-2.0
// Normal equations of unknowns along a chain (one block for each wavelength), each block coupled to its
// neighbours by a diagonal, and of unknowns that all blocks share (the border). Internal to the library, since
// it includes Eigen.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace aureole::pigment {

struct NormalChain {
  std::vector<Eigen::MatrixXd> blocks, to_border;
  /// minus the off-diagonal between blocks l and l + 1, a diagonal matrix
  std::vector<Eigen::VectorXd> coupling;
  Eigen::MatrixXd border;
};

/// Factors of a NormalChain whose diagonal is multiplied by 1 + damping (Levenberg and Marquardt). The chain must
/// outlive them.
class NormalChainFactors {
public:
  NormalChainFactors(const NormalChain& chain, double damping);

  /// False if the matrix is not positive definite. Nothing can be solved then.
  bool good() const { return good_; }
  /// Solves for several right-hand sides; the arguments are replaced by the solution.
  void solve(std::vector<Eigen::MatrixXd>& blocks, Eigen::MatrixXd& border) const;

private:
  void backward(std::vector<Eigen::MatrixXd>& y) const;

  const NormalChain& chain_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> factors_;
  std::vector<Eigen::MatrixXd> solved_;  ///< inverse of the chain without the border, times `to_border`
  Eigen::LLT<Eigen::MatrixXd> border_;
  bool good_ = true;
};

}  // namespace aureole::pigment
