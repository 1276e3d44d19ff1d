// Road Runner limits of ftc-mecanum on tiles, slip margin 0.1 (slipmargin)
// accelerations: safe in every direction of motion, with 4.751 rad/s^2 of yaw acceleration at once
// the largest box for tools with a number an axis, the largest circle for tools with one number
// speeds: 62.4 % of the wheels' top speed, each axis alone; there these accelerations and drag take 90 % of the motors' torque, which falls with the speed
// the centre of mass lies 0.02 m off the middle: turning at w rad/s while driving takes 0.02 w^2 m/s^2 of these accelerations
// x forward, y left
// path profile parameters (in inches)
public double maxWheelVel = 38.578;
public double minProfileAccel = -108.550;
public double maxProfileAccel = 108.550;
// turn profile parameters (in radians)
public double maxAngVel = 2.6627;
public double maxAngAccel = 4.7509;
