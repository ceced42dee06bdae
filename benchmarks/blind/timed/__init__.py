"""Materials with time dependence, damage and fibres, and their tests: homogeneous, beams and indentation.

    S = S_vol + S_iso + sum_i Q_i,    dQ_i/dt + Q_i/tau_i = g_i dS_iso/dt,    S_iso = eta 2 dW/dC

W is the long-time isochoric energy of an Ogden law and one family of fibres (Holzapfel, Gasser and Ogden
2000), eta the softening of Ogden and Roxburgh (1999) by W and its largest value so far, Q_i the internal
stresses of finite linear viscoelasticity (Simo 1987; Holzapfel 2000, chapter 6). Laws, time integration and
finite elements share no code with the packages under test, and the integration rules differ: an implicit
Runge-Kutta method for the memory integrals of homogeneous tests, exact convolution of piecewise linear
stresses for beams and indentation.
"""
