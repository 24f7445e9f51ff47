//! (11), (12), (16) and what stands between them, as printed.

/// The third line of (12).
pub(super) const THIRD: &str = "R_r*exp(2*beta*R)*[dC*(R*cos(2*beta*alpha0) - alpha0*sin(2*beta*alpha0)) \
     + dD*(R*sin(2*beta*alpha0) + alpha0*cos(2*beta*alpha0)) \
     + 1/omega*(dphi' - dphi)*[(R^2*C - alpha0^2*C + 2*R*alpha0*D)*cos(2*beta*alpha0) \
     + (R^2*D - alpha0^2*D - 2*R*alpha0*D)*sin(2*beta*alpha0)]] \
     + R*dC' + alpha0*dD' - (R_r + 1)*a*omega*dphi'*cos(phi)";

const END_VELOCITY: &str = "exp((2*pi*k/omega + dT)*R)*[\
     R*alpha0*dT*[D*cos((2*pi*k/omega + dT)*alpha0) - C*sin((2*pi*k/omega + dT)*alpha0)] \
     + R*dC*cos((2*pi*k/omega + dT)*alpha0) + R*dD*sin((2*pi*k/omega + dT)*alpha0) \
     + R^2*dT*C*cos((2*pi*k/omega + dT)*alpha0) + R^2*dT*D*sin((2*pi*k/omega + dT)*alpha0) \
     - alpha0^2*dT*[C*cos((2*pi*k/omega + dT)*alpha0) + D*sin((2*pi*k/omega + dT)*alpha0)] \
     - dC*alpha0*sin((2*pi*k/omega + dT)*alpha0) + dD*alpha0*cos((2*pi*k/omega + dT)*alpha0) \
     - R*dT*C*alpha0*sin((2*pi*k/omega + dT)*alpha0) \
     + R*dT*D*alpha0*cos((2*pi*k/omega + dT)*alpha0)] \
     - a*omega*dphi*cos((2*pi*k/omega + dT)*omega + phi) \
     - a*omega^2*dT*cos((2*pi*k/omega + dT)*omega + phi)";

const END_DISPLACEMENT: &str = "exp((2*pi*k/omega + dT)*R)*[\
     alpha0*dT*[D*cos((2*pi*k/omega + dT)*alpha0) - C*sin((2*pi*k/omega + dT)*alpha0)] \
     + dC*cos((2*pi*k/omega + dT)*alpha0) + dD*sin((2*pi*k/omega + dT)*alpha0) \
     + R*dT*C*cos((2*pi*k/omega + dT)*alpha0) + R*dT*D*sin((2*pi*k/omega + dT)*alpha0)] \
     - a*dphi*sin((2*pi*k/omega + dT)*omega + phi) \
     - a*omega*dT*sin((2*pi*k/omega + dT)*omega + phi)";

/// The small changes in flight.
pub(super) const DISPLACEMENT: &str = "exp(R*tau)*[-C*alpha0*dtau*sin(alpha0*tau) + dC*cos(alpha0*tau) \
     + D*alpha0*dtau*cos(alpha0*tau) + dD*sin(alpha0*tau) + R*C*dtau*cos(alpha0*tau) \
     + R*D*dtau*sin(alpha0*tau)] - a*dphi*sin(omega*tau + phi) - a*omega*dtau*sin(omega*tau + phi)";

pub(super) const VELOCITY: &str = "exp(R*tau)*[-R*alpha0*dtau*(D*cos(alpha0*tau) - C*sin(alpha0*tau)) \
     + R*dC*cos(alpha0*tau) + R*dD*sin(alpha0*tau) + R^2*C*dtau*cos(alpha0*tau) \
     + R^2*D*dtau*sin(alpha0*tau) - alpha0^2*dtau*(C*cos(alpha0*tau) - D*sin(alpha0*tau)) \
     - alpha0*dC*sin(alpha0*tau) + alpha0*dD*cos(alpha0*tau) - R*dtau*C*alpha0*sin(alpha0*tau) \
     + R*dtau*D*alpha0*cos(alpha0*tau)] - a*omega*dphi*cos(omega*tau + phi) \
     - a*omega^2*dtau*cos(omega*tau + phi)";

/// b_2, b_1, b_0.
pub(super) const B: [&str; 3] = [
    "alpha0*[a*sin(phi) - 1/omega*exp(2*beta*R)*[(alpha0*D + R*C)*cos(2*beta*alpha0) \
     + (R*D - alpha0*C)*sin(2*beta*alpha0)]]",
    "exp(2*beta*R)*[1/omega*alpha0*[(R*C + alpha0*D)*(cos(2*beta*alpha0) - R_r*exp(2*beta*R)) \
     + (R*D - alpha0*C)*sin(2*beta*alpha0)] - (R_r + 1)*a*omega*cos(phi)*sin(2*beta*alpha0) \
     + a*sin(phi)*[(R_r - 1)*alpha0*cos(2*beta*alpha0) + (R_r + 1)*R*sin(2*beta*alpha0)]]",
    "R_r*alpha0*exp(4*beta*R)*[1/omega*(R*C + alpha0*D) - a*sin(phi)]",
];

/// (11): label, left side, formula, remark.
pub(super) const ELEVEN: [[&str; 4]; 6] = [
    ["(11), 1", "0 = ", "dC - a*dphi*sin(phi)", ""],
    ["(11), 2", "delta x'_+ = ", "R*dC + dD*alpha0 - a*omega*dphi*cos(phi)", ""],
    ["(11), 3", "0 = ", "dC' - a*dphi'*sin(phi)", ""],
    ["(11), 4", "delta x'_+' = ", "R*dC' + dD'*alpha0 - a*omega*dphi'*cos(phi)", ""],
    ["(11), 5", "0 = ", END_DISPLACEMENT, INSIDE],
    ["(11), 6", "delta x'_-' = ", END_VELOCITY, INSIDE],
];
const INSIDE: &str = "$dT$ inside the functions is of second order";

/// The lines of (12).
pub(super) const TWELVE: [&str; 3] = ["dC - a*dphi*sin(phi)", SECOND, THIRD];
const SECOND: &str = "exp(2*beta*R)*[dC*cos(2*beta*alpha0) + dD*sin(2*beta*alpha0) \
     + 1/omega*(dphi' - dphi)*[(alpha0*D + R*C)*cos(2*beta*alpha0) \
     + (R*D - alpha0*C)*sin(2*beta*alpha0)]] - dC'";
