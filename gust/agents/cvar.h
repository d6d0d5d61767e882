#pragma once

namespace gust {

/// How the coefficient of a normal law's conditional value at risk is read (docs/algorithms.md 4.2).
enum class CvarForm {
  kCorrect,  ///< phi(z) / alpha with z = Phi^-1(alpha): the lower tail's mean of N(0, 1) is -c(alpha), and c(1) = 0
  kLiteral,  ///< phi(alpha) / Phi(alpha), as it is printed
};

/// c in CVaR_alpha(N(Q, s^2)) = Q - c s. alpha is a probability in (0, 1].
double cvar_coefficient(double alpha, CvarForm form = CvarForm::kCorrect);

}  // namespace gust
