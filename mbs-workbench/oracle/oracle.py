"""Evaluates a mechanism's definition at given states, with derivatives that a back end finds by itself.

    python oracle.py BACK_END.py DEFINITION.py < states.json > values.json

The definition is a Python file with

    NAME    name of the mechanism
    N       number of coordinates
    M       number of constraint rows; N where it is left out
    V       number of variables: parameters and inputs, component by component
    RATES   triples (value, rate, acceleration) of indices into v, one for each input with rates
    define(ca, q, v, t, der) -> (phi, outs)

where phi is the list of residuals and outs a list of pairs (expression, number of time derivatives that the
definition leaves: 0, 1 or 2; -1 where the definition has no word for the output itself). ca holds the functions of the
module casadi, and gain(e, rows, row, sign): the derivative of e along the drive whose row, of all the rows, rises by
sign where the coordinates alone move. der(e) is the total time derivative: t -> 1, q -> qd, qd -> qdd, and along RATES
v[value] -> v[rate], v[rate] -> v[acceleration].

A definition of a mechanism with masses or forces has also

    K       number of first-order states
    dynamics(ca, q, v, t, der, z, l) -> dictionary of lists

where z are the states and l the multipliers of the rows. `kinetic` and `potential` are terms of the energies, `forces`
dictionaries: `work`, pairs of a value and the displacement that it acts along (without what is stored as potential
energy), `rayleigh`, a function R with the generalized forces -dR/dqd, or None, `stored`, what a spring keeps, where one
does. `rates` are those of the states, `loads` the outputs that use z or l.

The back end is a Python file with evaluate(definition, states) -> {function: [values a state]}.

In:  {"states": [{"q": [], "qd": [], "qdd": [], "t": 0.0, "v": [], "z": [], "l": []}]}
Out: {"name", "n", "m", "v", "phi": [[..]], "phi_q": [[row after row]], "phi_t", "phi_tt", "phi_qt_qd", "gamma",
      "out", "out_d", "out_dd"}, one list a state; a derivative that does not exist is null, and so is an output that
      the definition has no word for, or that CasADi's solution of its own Jacobian leaves too few digits. Of a mechanism with masses
      CasADi gives "mass", "mass_times", "force", "force_q", "force_qd", "mass_times_q", "reaction", "reaction_q",
      "energy", "powers", "state_rates" and "loads" too, M x and its derivative with x = qdd.
"""

import importlib.util
import json
import sys


def load(name, path):
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def check_sizes(definition, states):
    for state in states:
        given = len(state["q"]), len(state["v"])
        if given != (definition.N, definition.V):
            sys.exit(
                f"the definition `{definition.NAME}` has {definition.N} coordinates and {definition.V} variables, "
                f"the states have {given[0]} and {given[1]}"
            )


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: oracle.py BACK_END.py DEFINITION.py < states.json > values.json")
    back_end, definition = load("back_end", sys.argv[1]), load("definition", sys.argv[2])
    if not hasattr(definition, "M"):
        definition.M = definition.N
    if not hasattr(definition, "K"):
        definition.K = 0
    states = json.load(sys.stdin)["states"]
    check_sizes(definition, states)
    sizes = {"name": definition.NAME, "n": definition.N, "m": definition.M, "v": definition.V}
    json.dump(sizes | back_end.evaluate(definition, states), sys.stdout)


if __name__ == "__main__":
    main()
